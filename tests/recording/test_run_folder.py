from datetime import datetime

import cv2
import numpy as np
import pytest
from scripted_mission import RESULT, finished

from zavis_bt.errors import InputError
from zavis_bt.recording import RunRecorder, load_run, new_run_folder
from zavis_bt.types import Event


@pytest.fixture
def recorded(tmp_path):
    recorder = RunRecorder(tmp_path / "run", {"target": "alarm clock", "seed": 7})
    mission = finished()
    recorder.on_start(mission)
    recorder.on_event(Event(1.0, "visit", {"viewpoint": mission.visited[0]}))
    recorder.on_event(Event(2.0, "candidates", {"candidates": mission.candidates}))
    for share in (0.2, 0.4, 0.4, 0.6):
        mission.go(share)
        recorder.on_tick(mission)
    recorder.on_end(finished(), RESULT)
    assert recorder.problems == []
    return load_run(tmp_path / "run")


def test_result_and_settings_come_back(recorded):
    assert recorded.status == "ended"
    assert recorded.result == RESULT
    assert recorded.settings == {"target": "alarm clock", "seed": 7}
    assert {"python", "zavis_bt", "numpy"} <= set(recorded.versions)


def test_map_and_landmarks_come_back(recorded):
    mission = finished()
    np.testing.assert_array_equal(recorded.grid.states, mission.grid.states)
    assert recorded.grid.origin == mission.grid.origin
    assert recorded.landmarks == mission.landmarks


def test_trajectory_has_a_row_for_each_motion_and_none_for_rest(recorded):
    assert len(recorded.trajectory) == 4
    assert np.all(np.diff(recorded.trajectory[1:, 0]) > 0)


def test_candidates_are_listed_with_their_pictures(recorded):
    assert [entry["accepted"] for entry in recorded.candidates] == [False, False, True]
    assert recorded.candidates[2]["score"] == 33.1
    for entry in recorded.candidates:
        assert (recorded.folder.candidates / entry["file"]).read_bytes().startswith(b"\x89PNG")


def test_events_come_back_in_order_without_pictures(recorded):
    assert [event.kind for event in recorded.events] == ["visit", "candidates"]
    assert recorded.events[0].data["viewpoint"]["landmark"] == 1
    assert recorded.events[1].data["candidates"][0]["score"] == 29.8
    assert recorded.folder.events.stat().st_size < 5000


def test_tree_text_has_statuses_and_reasons(recorded):
    assert "✗ confirm: none of 2 is the target" in recorded.tree
    assert recorded.tree.startswith("→ mission (sequence)\n  ✓ safe (check)")


def test_nothing_but_the_run_is_left_in_the_folder(recorded):
    names = {path.name for path in recorded.folder.path.iterdir()}
    assert names == {
        "run.json", "events.jsonl", "map.yaml", "map.pgm", "semantic_map.json", "trajectory.csv", "tree.txt", "map.png",
        "candidates",
    }  # fmt: skip


def test_killed_run_is_readable(tmp_path):
    recorder = RunRecorder(tmp_path, {"seed": 1})
    recorder.on_event(Event(1.0, "scan", {}))
    with (tmp_path / "events.jsonl").open("a") as file:
        file.write('{"stamp": 2.0, "ki')
    run = load_run(tmp_path)
    recorder.close()
    assert (run.status, run.result, run.grid, run.settings) == ("running", None, None, {"seed": 1})
    assert [event.kind for event in run.events] == ["scan"]


def test_folder_with_a_run_is_refused(tmp_path):
    RunRecorder(tmp_path, {}).close()
    with pytest.raises(InputError, match=r"holds a run already .choose another folder"):
        RunRecorder(tmp_path, {})


def test_folder_that_cannot_be_made_is_one_clear_line(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match=r"file/run: cannot be written: Not a directory"):
        RunRecorder(tmp_path / "file" / "run", {})


def test_file_that_cannot_be_written_does_not_cost_the_others(tmp_path, caplog):
    recorder = RunRecorder(tmp_path, {})
    (tmp_path / "map.yaml").mkdir()  # nothing can be moved to where a folder is
    (tmp_path / "candidates").write_text("")
    recorder.on_end(finished(), RESULT)
    run_json = (tmp_path / "run.json").read_text()
    assert [problem.split(":")[0] for problem in recorder.problems] == ["map.yaml", "candidates"]
    assert '"status": "ended"' in run_json
    assert "map.yaml: cannot be written: Is a directory" in run_json
    assert (tmp_path / "map.png").is_file()
    assert "recording:" in caplog.text


def test_full_disk_ends_the_journal_and_not_the_mission(tmp_path, caplog):
    recorder = RunRecorder(tmp_path, {})
    recorder.close()
    with open("/dev/full", "wb", buffering=0) as full:
        recorder._events = full
        recorder.on_event(Event(1.0, "scan", {}))
        recorder.on_event(Event(2.0, "scan", {}))
    assert recorder.problems == ["events.jsonl: cannot be written: No space left on device"]


def test_broken_frame_costs_only_the_candidates(tmp_path, caplog):
    mission = finished()
    mission.found.frame.__dict__["_pixels"] = None
    recorder = RunRecorder(tmp_path, {})
    recorder.on_end(mission, RESULT)
    assert [problem.split(":")[0] for problem in recorder.problems] == ["candidates"]
    mission.found.frame.__dict__.pop("_pixels")


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (None, "holds no run"),
        ("{", "not JSON"),
        ('{"format": "other/1"}', "not a run .format 'zavis-run/1' would be right"),
        ('{"format": "zavis-run/1", "success": true}', "id is missing"),
    ],
)
def test_what_is_no_run_is_said_so(tmp_path, content, message):
    if content is not None:
        (tmp_path / "run.json").write_text(content)
    with pytest.raises(InputError, match=message):
        load_run(tmp_path)


def test_names_of_new_folders_are_free(tmp_path):
    stamp = datetime(2025, 3, 8, 14, 5, 9)
    first = new_run_folder(tmp_path, stamp)
    first.mkdir()
    assert first.name == "2025-03-08_14-05-09"
    assert new_run_folder(tmp_path, stamp).name == "2025-03-08_14-05-09-2"


def test_reasons_of_many_lines_take_one_in_tree_and_title(tmp_path):
    from dataclasses import replace

    mission = finished()
    mission.nodes = (replace(mission.nodes[0], reason="\nfirst line\nsecond line"), *mission.nodes[1:])
    recorder = RunRecorder(tmp_path, {"target": "cup"})
    recorder.on_end(mission, replace(RESULT, success=False, reason="a/b: crash\n" + 99 * "more "))
    assert recorder.problems == []
    assert (tmp_path / "tree.txt").read_text().splitlines()[0] == "→ mission (sequence): first line"
    assert cv2.imread(str(tmp_path / "map.png")).shape[1] < 1500
