"""Run folders: what a mission leaves behind, and reading it back."""

from zavis_bt.recording.picture import draw_map
from zavis_bt.recording.plain import to_json, to_plain
from zavis_bt.recording.recorder import RunRecorder
from zavis_bt.recording.run_folder import Run, RunFolder, load_run, new_run_folder

__all__ = [
    "Run",
    "RunFolder",
    "RunRecorder",
    "draw_map",
    "load_run",
    "new_run_folder",
    "to_json",
    "to_plain",
]
