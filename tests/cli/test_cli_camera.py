from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest
from camera_boards import BoardCamera, poses
from typer.testing import CliRunner, Result

from drivers import builtin_robot
from drivers.camera import RecordingWriter
from drivers.camera.calibration_file import read_calibration, read_stereo
from drivers.camera.recording import read_recording
from zavis_bt.cli.camera import app
from zavis_bt.errors import DeviceError, InputError
from zavis_bt.types import CameraIntrinsics, RgbdFrame

RIGHT = BoardCamera(x=0.06)


@pytest.fixture(scope="module")
def boards(tmp_path_factory) -> Path:
    """Folders ``left`` and ``right`` of seven views, ``both`` with the eyes side by side."""
    folder = tmp_path_factory.mktemp("boards")
    left = BoardCamera()
    for number, pose in enumerate(poses(7)):
        eyes = {"left": left.see(*pose, noise=number), "right": RIGHT.see(*pose, noise=50 + number)}
        eyes["both"] = np.hstack(list(eyes.values()))
        for name, image in eyes.items():
            (folder / name).mkdir(exist_ok=True)
            cv2.imwrite(str(folder / name / f"{number}.png"), image)
    return folder


@pytest.fixture
def zavis_camera(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)

    def run(*arguments: object) -> Result:
        return CliRunner().invoke(app, [str(argument) for argument in arguments])

    return run


def test_a_folder_of_chessboards_calibrates_a_camera(zavis_camera, boards, tmp_path):
    extra = tmp_path / "images"
    extra.mkdir()
    for path in (boards / "left").iterdir():
        (extra / path.name).write_bytes(path.read_bytes())
    cv2.imwrite(str(extra / "8.png"), np.full((480, 640, 3), 90, np.uint8))
    (extra / "9.jpg").write_bytes(b"no image")
    result = zavis_camera("calibrate", extra, "--square", "0.03", "--out", "camera.yaml")
    assert result.exit_code == 0, result.output
    assert "0.png: view 1" in result.output
    assert "8.png: left out: no board of 9 x 6 inner corners" in result.output
    assert "9.jpg: left out: is no image" in result.output
    assert "over 7 views: very good" in result.output
    assert "hold some near its edges" in result.output
    calibration = read_calibration(tmp_path / "camera.yaml")
    assert calibration.matrix[0, 0] == pytest.approx(520.0, abs=8.0)
    assert f"focal lengths {calibration.matrix[0, 0]:.1f}" in result.output
    pictures = tmp_path / "camera_pictures"
    assert len(list(pictures.glob("corners_*.png"))) == 7
    assert cv2.imread(str(pictures / "undistorted.png")).shape == (480, 1280, 3)


def test_views_of_both_eyes_calibrate_a_pair(zavis_camera, boards, tmp_path):
    sources = boards / "both", "--side-by-side"
    result = zavis_camera("calibrate", *sources, "--square", "0.03", "--out", "pair.yaml", "--pictures", "seen")
    assert result.exit_code == 0, result.output
    assert read_stereo(tmp_path / "pair.yaml").baseline == pytest.approx(0.06, abs=0.002)
    assert "baseline" in result.output
    assert cv2.imread(str(tmp_path / "seen" / "rectified.png")).shape == (480, 1280, 3)


def test_a_video_is_looked_through_until_there_are_enough_views(zavis_camera, boards, tmp_path):
    writer = cv2.VideoWriter("boards.avi", cv2.VideoWriter_fourcc(*"MJPG"), 10.0, (640, 480))
    for number in range(7):
        for _ in range(2):
            writer.write(cv2.imread(str(boards / "left" / f"{number}.png")))
    writer.release()
    options = ("--square", "0.03", "--out", "camera.yaml", "--views", "6", "--every", "0.2")
    result = zavis_camera("calibrate", "boards.avi", *options)
    assert result.exit_code == 0, result.output
    assert "view 6: view 6" in result.output
    assert "view 7" not in result.output


@pytest.mark.parametrize(
    ("arguments", "error", "words"),
    [
        (["nowhere"], DeviceError, "there is no nowhere"),
        (["63"], DeviceError, "there is no /dev/video63"),
        (["empty"], InputError, "empty: holds no images"),
        (["LEFT", "--board", "big"], InputError, "--board: 'big' is no board"),
        (["LEFT", "few"], InputError, "hold 7 and 1 images"),
        (["LEFT", "0"], InputError, "a folder and a camera cannot be a pair"),
        (["LEFT", "LEFT", "LEFT"], InputError, "give one source, or two"),
        (["few"], InputError, "1 views are of use"),
        (["LEFT", "--out", "no/camera.yaml"], InputError, "--out: there is no folder no"),
    ],
)
def test_what_cannot_be_calibrated_is_said_in_one_line(zavis_camera, boards, tmp_path, arguments, error, words):
    (tmp_path / "empty").mkdir()
    (tmp_path / "few").mkdir()
    (tmp_path / "few" / "0.png").write_bytes((boards / "left" / "0.png").read_bytes())
    filled = [boards / "left" if argument == "LEFT" else argument for argument in arguments]
    out = [] if "--out" in arguments else ["--out", "camera.yaml"]
    result = zavis_camera("calibrate", *filled, "--square", "0.03", *out)
    assert isinstance(result.exception, error)
    assert words in str(result.exception)
    assert "\n" not in str(result.exception)
    assert not (tmp_path / "camera.yaml").exists()


def test_grab_saves_what_a_robots_camera_sees(zavis_camera, tmp_path):
    intrinsics = CameraIntrinsics(8, 6, 9.0, 9.0, 4.0, 3.0)
    images = np.full((6, 8, 3), 50, np.uint8), np.full((6, 8), 2.5, np.float32)
    writer = RecordingWriter(tmp_path / "tape", intrinsics)
    for stamp in (0.0, 0.05):
        writer.add(RgbdFrame(intrinsics, np.eye(4), stamp, lambda: images))
    text = builtin_robot("pioneer3at").read_text()
    (tmp_path / "my.robot.yaml").write_text(
        text + f"devices:\n  camera: {{driver: recorded, settings: {{folder: {tmp_path / 'tape'}}}}}\n"
    )
    result = zavis_camera("grab", "my.robot.yaml", "--frames", "3")
    assert result.exit_code == 0, result.output
    assert "grabbed: 3 frames" in result.output
    frames = read_recording(tmp_path / "grabbed")
    assert len(frames) == 3
    assert frames[0].pixels()[1][0, 0] == pytest.approx(2.5)
    assert isinstance(zavis_camera("grab", "my.robot.yaml").exception, InputError)
