import gc
import logging
import os
import signal
import subprocess
import sys
import time
from dataclasses import replace
from io import BytesIO

import numpy as np
import pytest
import umsgpack
from PIL import Image
from scripted_mission import LANDMARKS, RESULT, ROBOT, ScriptedMission, apartment, finished

from zavis_bt.errors import DeviceError
from zavis_bt.types import FREE, OCCUPIED, UNKNOWN, Footprint, GridMap, Path
from zavis_bt.viz import MeshcatViewer
from zavis_bt.viz.ground import WALL_HEIGHT, floor_image, walls
from zavis_bt.viz.scene import Scene
from zavis_bt.viz.solids import box, cylinder, merged, ribbon


@pytest.fixture(scope="module")
def viewer():
    with MeshcatViewer(port=0) as view:
        yield view


def names(messages):
    return {message.name for message in messages}


# -- the scene ------------------------------------------------------------------------------------------------------


def test_everything_a_mission_shows_is_drawn():
    mission = finished()
    mission.path = Path(mission.trajectory[:20])
    drawn = names(Scene().news(mission, 0.0))
    for part in (
        "map/floor#object",
        "map/walls#object",
        "robot#transform",
        "robot/camera#transform",
        "robot/lidar/hits#object",
        "path#object",
        "trajectory#object",
        "landmarks/3/name#object",
        "viewpoints/4/number#object",
        "candidates/1/marker#object",
        "candidates/found/pillar#object",
        "words#tree",
        "words#facts",
        "words#view",
    ):
        assert f"/zavis/{part}" in drawn


def test_nothing_is_sent_when_nothing_changed():
    scene, mission = Scene(), finished()
    list(scene.news(mission, 0.0))
    assert names(scene.news(mission, 0.1)) == set()


def test_only_what_changed_is_sent():
    scene, mission = Scene(), ScriptedMission()
    mission.landmarks = LANDMARKS[:2]
    list(scene.news(mission, 0.0))
    mission.landmarks = LANDMARKS[:3]
    assert {name.split("#")[0] for name in names(scene.news(mission, 0.1))} == {
        f"/zavis/landmarks/2/{part}" for part in ("area", "solid", "name")
    }


def test_what_is_gone_is_deleted_and_drawn_again_when_it_comes_back():
    scene, mission = Scene(), ScriptedMission()
    mission.landmarks = LANDMARKS[:1]
    list(scene.news(mission, 0.0))
    mission.landmarks = ()
    assert names(scene.news(mission, 0.1)) == {"/zavis/landmarks/0#delete"}
    mission.landmarks = LANDMARKS[:1]
    assert "/zavis/landmarks/0/name#object" in names(scene.news(mission, 0.2))


def test_visited_viewpoints_keep_their_numbers():
    scene, mission = Scene(), ScriptedMission()
    first = mission.viewpoints
    list(scene.news(mission, 0.0))
    mission.visited, mission.viewpoints = first[:1], first[1:]
    changed = {name.split("/")[3] for name in names(scene.news(mission, 0.1)) if "/viewpoints/" in name}
    assert changed == {"1"}


def test_names_of_landmarks_close_together_stand_at_different_heights():
    scene, mission = Scene(), ScriptedMission()
    mission.landmarks = tuple(replace(LANDMARKS[0], id=number) for number in range(3))
    messages = {message.name: umsgpack.unpackb(message.payload) for message in scene.news(mission, 0.0)}
    heights = [messages[f"/zavis/landmarks/{i}/name#object"]["object"]["object"]["matrix"][14] for i in range(3)]
    assert np.diff(heights) == pytest.approx(0.3)


def test_map_is_drawn_at_most_twice_a_second():
    scene, mission = Scene(), ScriptedMission()
    sent = 0
    for tick in range(41):
        mission.grid = apartment(1.0, tick)
        sent += "/zavis/map/floor#object" in names(scene.news(mission, tick * 0.05))
    assert 2 <= sent <= 5


def test_payloads_are_commands_for_their_paths():
    scene, mission = Scene(), finished()
    for message in [*scene.opening(ROBOT, "a title"), *scene.news(mission, 0.0), *scene.closing(RESULT)]:
        command = umsgpack.unpackb(message.payload)
        path, slot = message.name.split("#")
        if path.endswith("/words"):
            assert command["type"] == slot
        else:
            assert command["path"] == path
            assert command["type"].removeprefix("set_") == slot


def test_transform_puts_the_robot_where_it_is():
    mission = finished()
    messages = {message.name: message.payload for message in Scene().news(mission, 0.0)}
    matrix = np.reshape(umsgpack.unpackb(messages["/zavis/robot#transform"])["matrix"], (4, 4)).T
    pose = mission.base.pose
    np.testing.assert_allclose(matrix[:3, 3], [pose.x, pose.y, 0])
    np.testing.assert_allclose(matrix[:2, 0], [np.cos(pose.yaw), np.sin(pose.yaw)])


@pytest.mark.parametrize("shape", [(0, 0), (3, 3)])
def test_a_mission_that_knows_nothing_yet_can_be_shown(shape):
    mission = ScriptedMission(grid=GridMap(np.full(shape, UNKNOWN, dtype=np.int8), 0.05, (0.0, 0.0)))
    assert "/zavis/map/walls#object" not in names(Scene().news(mission, 0.0))


def test_disc_robots_and_missing_things_can_be_drawn():
    mission = ScriptedMission()
    mission.robot = replace(ROBOT, footprint=Footprint(0.4, 0.4, disc=True))
    mission.grid = GridMap(np.full((3, 3), -1, dtype=np.int8), 0.05, (0.0, 0.0))
    assert list(Scene().opening(mission.robot, ""))
    assert "/zavis/path#object" not in names(Scene().news(mission, 0.0))


def test_floor_image_has_the_cells_north_up_and_nothing_where_unknown():
    grid = apartment(0.5)
    image = np.asarray(Image.open(BytesIO(floor_image(grid))).convert("RGBA"))[::-1]
    np.testing.assert_array_equal(image[..., 3] == 0, grid.states == UNKNOWN)
    np.testing.assert_array_equal(image[..., 0] < 200, grid.states == OCCUPIED)


def test_walls_stand_on_the_occupied_cells():
    grid = apartment()
    solid = walls(grid)
    lids = solid.vertices[solid.vertices[:, 2] > 0.9 * WALL_HEIGHT]
    rows, cols = np.nonzero(grid.states == OCCUPIED)
    corners = grid.to_points(np.column_stack((rows, cols)))
    np.testing.assert_allclose(lids[:, :2].min(axis=0), corners.min(axis=0) - 0.025, atol=1e-5)
    np.testing.assert_allclose(lids[:, :2].max(axis=0), corners.max(axis=0) + 0.025, atol=1e-5)


@pytest.mark.parametrize("seed", range(3))
def test_lids_of_walls_cover_exactly_the_occupied_area(seed):
    states = np.where(np.random.default_rng(seed).random((9, 13)) < 0.4, OCCUPIED, FREE).astype(np.int8)
    solid = walls(GridMap(states, 0.5, (1.0, -2.0)))
    a, b, c = (solid.vertices[solid.faces[:, i]] for i in range(3))
    normal = np.cross(b - a, c - a) / 2
    assert np.abs(normal[:, 2]).sum() == pytest.approx((states == OCCUPIED).sum() * 0.25, rel=1e-5)
    side = np.abs(normal[:, :2]).sum()
    padded = np.pad(states == OCCUPIED, 1)
    edges = (padded[1:] != padded[:-1]).sum() + (padded[:, 1:] != padded[:, :-1]).sum()
    assert side == pytest.approx(edges * 0.5 * WALL_HEIGHT, rel=1e-5)


def test_no_walls_without_occupied_cells():
    assert walls(GridMap(np.zeros((4, 4), dtype=np.int8), 0.1, (0.0, 0.0))) is None


def test_faces_of_solids_refer_to_their_vertices():
    band = ribbon(np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]), np.ones((3, 3)), 0.1, 0.0)
    solid = merged([box((0, 0, 0), (1, 2, 3), (255, 0, 0)), cylinder((0, 0, 0), 1, 2, (0, 255, 0)), band])
    assert solid.faces.max() == len(solid.vertices) - 1
    assert len(solid.colours) == len(solid.vertices)
    assert np.isfinite(solid.vertices).all()


# -- the viewer -----------------------------------------------------------------------------------------------------


def test_without_a_browser_nothing_waits(viewer):
    began = time.monotonic()
    assert not viewer.wait_for_browser()
    viewer.on_start(ScriptedMission())
    viewer.on_tick(ScriptedMission())
    assert time.monotonic() - began < 1.0


def test_page_and_script_are_served_to_this_machine_only(viewer):
    from urllib.request import urlopen

    assert viewer.url.startswith("http://127.0.0.1:")
    with urlopen(viewer.url) as answer:
        assert b"meshcat-pane" in answer.read()
    with urlopen(viewer.url + "static/main.min.js") as answer:
        assert len(answer.read()) > 100_000


def test_taken_port_is_one_clear_line(viewer):
    port = int(viewer.url.rsplit(":", 1)[1].strip("/"))
    with pytest.raises(DeviceError, match=rf"browser view at 127.0.0.1:{port}: Address already in use"):
        MeshcatViewer(port=port)


def test_closing_twice_ends_the_server_and_leaves_nothing_open():
    view = MeshcatViewer(port=0)
    process = view._link._process
    view.on_start(finished())
    view.close()
    view.close()
    assert process.poll() == 0
    view.on_tick(finished())
    view.on_end(finished(), RESULT)
    del view, process
    gc.collect()  # an open pipe would warn here


def test_server_that_dies_is_logged_once_and_the_mission_goes_on(caplog):
    with MeshcatViewer(port=0) as view, caplog.at_level(logging.ERROR):
        view.on_start(finished())
        os.kill(view._link._process.pid, signal.SIGKILL)
        view._link._process.wait()
        for _ in range(3):
            view._due = 0.0
            view.on_tick(finished())
        view.on_end(finished(), RESULT)
    assert [record.message for record in caplog.records] == [
        f"browser view at {view.url}: its server has ended; the mission goes on unseen"
    ]


def test_server_that_hangs_does_not_stop_the_mission():
    view = MeshcatViewer(port=0)
    process = view._link._process
    os.kill(process.pid, signal.SIGSTOP)
    mission = finished()
    began = time.monotonic()
    view.on_start(mission)
    for share in np.linspace(0, 1, 50):  # more than a pipe holds
        mission.go(share)
        view._due = 0.0
        view.on_tick(mission)
    assert time.monotonic() - began < 1.5
    view._link.close()
    assert process.poll() is not None


def test_server_ends_when_the_mission_is_killed():
    script = (
        "import sys, time; from zavis_bt.viz import MeshcatViewer; view = MeshcatViewer(port=0);"
        "print(view._link._process.pid, flush=True); time.sleep(60)"
    )
    mission = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True)
    server = int(mission.stdout.readline())
    mission.kill()
    mission.wait()
    mission.stdout.close()
    end = time.monotonic() + 5
    while os.path.exists(f"/proc/{server}/stat") and time.monotonic() < end:
        with open(f"/proc/{server}/stat") as stat:
            if stat.read().split(") ")[1][0] == "Z":
                break  # ended; its new parent has not asked yet
        time.sleep(0.02)
    assert time.monotonic() < end


def test_frames_are_paced_by_wall_time_and_by_their_cost(viewer):
    mission = finished()
    viewer.on_start(mission)
    frames = []
    viewer._scene.news = lambda *_, **__: frames.append(time.monotonic()) or []
    end = time.monotonic() + 0.55
    while time.monotonic() < end:
        viewer.on_tick(mission)
    assert 4 <= len(frames) <= 6


def test_a_mission_in_lock_step_is_hardly_slowed(viewer):
    missions = [ScriptedMission() for _ in range(20)]
    for number, mission in enumerate(missions):
        mission.go(number / 20)

    def run(observers):
        began = time.perf_counter()
        for mission in missions + missions:
            end = time.perf_counter() + 0.01  # a tick's work
            while time.perf_counter() < end:
                pass
            for observer in observers:
                observer.on_tick(mission)
        return time.perf_counter() - began

    viewer.on_start(missions[0])
    run([viewer])
    assert min(run([viewer]) / run([]) for _ in range(2)) < 1.1
