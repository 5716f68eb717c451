"""The page in a real browser."""

import time
from dataclasses import replace

import cv2
import numpy as np
import pytest
from chromium import Page
from scripted_mission import RESULT, ScriptedMission, finished

from zavis_bt.types import NodeStatus
from zavis_bt.viz import MeshcatViewer

pytestmark = pytest.mark.browser


@pytest.fixture(scope="module")
def shown():
    with MeshcatViewer(port=0, title="find the <alarm> clock") as view:
        view.on_start(ScriptedMission())
        with Page(view.url) as page:
            assert view.wait_for_browser(10)
            yield view, page


def show(view, mission):
    view._due = view._scene._slow_due = 0.0
    view.on_tick(mission)
    assert view._link.flush(2)


def children(page, path):
    script = f"Object.keys(viewer.scene_tree.children.zavis.children['{path}']?.children ?? {{}}).sort().join()"
    return page.evaluate(script)


def pixels(page):
    return cv2.cvtColor(cv2.imdecode(np.frombuffer(page.screenshot(), np.uint8), cv2.IMREAD_COLOR), cv2.COLOR_BGR2RGB)


def test_page_shows_the_mission_and_keeps_up_with_it(shown):
    view, page = shown
    mission = finished()
    mission.visited, mission.viewpoints = mission.visited[:2], mission.visited[2:]
    show(view, mission)
    page.wait_for("viewer.scene_tree.children.zavis?.children.candidates?.children.found?.children.name !== undefined")
    assert children(page, "landmarks") == "0,1,2,3,4,5"
    assert children(page, "viewpoints") == "1,2,3,4"
    assert children(page, "map") == "floor,walls"
    position = page.evaluate("viewer.scene_tree.children.zavis.children.robot.object.position.toArray()")
    assert position[:2] == pytest.approx([mission.base.pose.x, mission.base.pose.y], abs=1e-6)

    mission.landmarks = mission.landmarks[:2]
    show(view, mission)
    page.wait_for("Object.keys(viewer.scene_tree.children.zavis.children.landmarks.children).length == 2")


def test_scene_is_drawn_and_fills_the_pane(shown):
    view, page = shown
    show(view, finished())
    time.sleep(0.5)  # images of the scene are decoded by the browser in its own time
    pane = pixels(page)[:, 400:].astype(int)
    background = np.median(pane[:, :20], axis=1)[:, None]
    drawn = np.abs(pane - background).sum(axis=2) > 40
    columns, rows = np.nonzero(drawn.any(axis=0))[0], np.nonzero(drawn.any(axis=1))[0]
    assert np.ptp(columns) > 0.7 * pane.shape[1] or np.ptp(rows) > 0.7 * pane.shape[0]
    free_floor = (pane > 245).all(axis=2).mean()
    assert free_floor > 0.15
    assert (np.abs(pane - [255, 199, 26]).sum(axis=2) < 60).sum() > 30  # the pillar over the find


def test_tree_panel_has_each_node_with_its_status_and_reason(shown):
    view, page = shown
    mission = finished()
    show(view, mission)
    page.wait_for("document.querySelectorAll('.node').length == 10")
    rows = page.evaluate(
        "[...document.querySelectorAll('.node')].map(n => [n.querySelector('.name').textContent, n.classList[1],"
        " n.querySelector('.reason')?.textContent ?? ''])"
    )
    assert rows == [[node.name, node.status.value, node.reason] for node in mission.nodes]
    mission.nodes = (replace(mission.nodes[0], status=NodeStatus.SUCCESS, reason="<b>done</b>"), *mission.nodes[1:])
    show(view, mission)
    page.wait_for("document.querySelector('.node.SUCCESS .reason')?.textContent == '<b>done</b>'")
    assert page.evaluate("document.querySelector('#title').textContent") == "find the <alarm> clock"


def test_camera_is_left_where_the_user_puts_it(shown):
    view, page = shown
    page.evaluate("viewer.controls.dispatchEvent({type: 'start'}); viewer.camera.position.set(1, 2, 3); 0")
    mission = ScriptedMission()
    mission.go(0.1)
    show(view, mission)
    page.wait_for("Object.keys(viewer.scene_tree.children.zavis.children.landmarks.children).length == 2")
    assert page.evaluate("viewer.camera.position.toArray()") == pytest.approx([1, 2, 3], abs=1e-6)
    page.evaluate("pane.dispatchEvent(new Event('dblclick')); 0")
    assert page.evaluate("viewer.camera.position.y") > 4


def test_page_that_comes_late_sees_all_and_the_end_reaches_it_before_the_server_goes(shown):
    view, page = shown
    page.load()
    page.wait_for("document.querySelectorAll('.node').length == 10")
    view.on_end(finished(), RESULT)
    view.close()
    page.wait_for("document.getElementById('state').textContent == 'found'")
    page.wait_for("viewer.connection.readyState == 3")
    assert page.evaluate("document.getElementById('why').textContent") == "after 14.2 m"
    assert page.evaluate("Object.keys(viewer.scene_tree.children.zavis.children.landmarks.children).length") == 6
