from __future__ import annotations

import cv2
import numpy as np
import pytest
from camera_rigs import context, wait_for

from drivers.camera import RecordingWriter, open_recorded, record
from drivers.camera.calibration_file import Calibration, write_calibration
from drivers.camera.recording import read_recording
from zavis_bt.errors import DeviceError, InputError
from zavis_bt.types import CameraIntrinsics, RgbdFrame

INTRINSICS = CameraIntrinsics(8, 6, 9.5, 9.25, 4.0, 3.125)


def frame(stamp: float, depth: float = 1.5, intrinsics: CameraIntrinsics = INTRINSICS) -> RgbdFrame:
    def pixels():
        rgb = np.arange(8 * 6 * 3, dtype=np.uint8).reshape(6, 8, 3)
        return rgb, np.full((6, 8), depth, np.float32)

    return RgbdFrame(intrinsics, np.eye(4), stamp, pixels)


@pytest.fixture
def folder(tmp_path):
    """Three frames, a tenth of a second apart, of growing depth."""
    writer = RecordingWriter(tmp_path / "tape", INTRINSICS)
    for number in range(3):
        writer.add(frame(5.0 + 0.1 * number, 1.0 + number))
    return tmp_path / "tape"


def test_what_is_written_is_read_again(folder):
    frames = read_recording(folder)
    assert [recorded.stamp for recorded in frames] == pytest.approx([5.0, 5.1, 5.2])
    for number, recorded in enumerate(frames):
        rgb, depth = recorded.pixels()
        np.testing.assert_array_equal(rgb, frame(0.0).rgb)
        np.testing.assert_allclose(depth, 1.0 + number, atol=0.0005)
        assert (rgb.dtype, depth.dtype) == (np.uint8, np.float32)
        for name in ("fx", "fy", "cx", "cy"):
            assert getattr(recorded.intrinsics, name) == pytest.approx(getattr(INTRINSICS, name))


def test_the_layout_is_the_benchmarks(folder):
    first = (folder / "rgb.txt").read_text().splitlines()[0]
    assert first == "5.000000 rgb/5.000000.png"
    image = cv2.imread(str(folder / "depth/5.100000.png"), cv2.IMREAD_UNCHANGED)
    assert image.dtype == np.uint16
    assert (image == 2000).all()


def test_depth_units_and_comments_and_stamps_apart_are_read_as_in_the_benchmark(folder):
    write_calibration(
        folder / "camera.yaml", Calibration((8, 6), np.diag([9.0, 9.0, 1.0]), np.zeros(5), depth_units=5000.0)
    )
    depths = (folder / "depth.txt").read_text().replace("5.100000 ", "5.112000 ").replace("5.200000 ", "5.250000 ")
    (folder / "depth.txt").write_text("# depth maps\n\n" + depths)
    frames = read_recording(folder)
    assert [recorded.stamp for recorded in frames] == pytest.approx([5.0, 5.1])
    assert frames[1].pixels()[1][0, 0] == pytest.approx(2000 / 5000)


def test_it_is_played_back_in_order_at_its_pace_and_again(folder):
    camera, depths, stamps = open_recorded({"folder": str(folder)}, context()), [], []
    try:
        while len(depths) < 5:
            assert wait_for(lambda: (now := camera.frame()) is not None and (not stamps or now.stamp > stamps[-1]))
            latest = camera.frame()
            stamps.append(latest.stamp)
            depths.append(round(float(latest.depth[0, 0])))
    finally:
        camera.close()
    steps = np.diff(depths) % 3
    assert (steps == 1).mean() >= 0.5  # a machine under load may miss some
    assert min(np.diff(stamps)) > 0.0
    assert stamps[-1] - stamps[0] > 0.2


def test_without_loop_the_last_frame_stays(folder):
    camera = open_recorded({"folder": str(folder), "loop": False, "speed": 20.0}, context())
    assert wait_for(lambda: (now := camera.frame()) is not None and round(float(now.depth[0, 0])) == 3)
    last = camera.frame()
    assert not wait_for(lambda: camera.frame() is not last, 0.15)
    camera.close()


def test_a_camera_is_recorded(tmp_path, folder):
    camera = open_recorded({"folder": str(folder), "speed": 5.0}, context())
    record(camera.frame, tmp_path / "copy", 4)
    camera.close()
    assert len(read_recording(tmp_path / "copy")) == 4


def test_a_camera_without_frames_is_not_waited_for_forever(tmp_path):
    with pytest.raises(DeviceError, match="no frame for"):
        record(lambda: None, tmp_path / "tape", 1, patience=0.05)
    assert not (tmp_path / "tape").exists()


def test_nothing_is_overwritten_and_intrinsics_may_not_change(folder):
    with pytest.raises(InputError, match="is not empty"):
        RecordingWriter(folder, INTRINSICS)
    writer = RecordingWriter(folder.parent / "new", INTRINSICS)
    with pytest.raises(InputError, match="intrinsics have changed"):
        writer.add(frame(1.0, intrinsics=CameraIntrinsics(8, 6, 9.0, 9.0, 4.0, 3.0)))


def spoil(folder, name: str, content: str | None) -> None:
    if content is None:
        (folder / name).unlink()
    else:
        (folder / name).write_text(content)


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("camera.yaml", None, "camera.yaml: cannot be read"),
        ("camera.yaml", "hello", "is not YAML as OpenCV writes it"),
        ("camera.yaml", "%YAML:1.0\n---\nimage_width: 8\nimage_height: 6\n", "camera_matrix: is missing"),
        ("camera.yaml", "%YAML:1.0\n---\nimage_width: -8\n", "image_width: is missing or no positive number"),
        ("rgb.txt", None, "rgb.txt: cannot be read"),
        ("rgb.txt", "5.0 a.png\nsoon b.png\n", "rgb.txt:2: 'soon b.png' is not '<stamp> <file>'"),
        ("rgb.txt", "5.0\n", "rgb.txt:1"),
        ("rgb.txt", "", "no line of rgb.txt"),
        ("depth.txt", "9.0 depth/5.000000.png\n", "has one of depth.txt within"),
    ],
)
def test_a_folder_with_a_fault_is_refused_in_one_line(folder, name, content, words):
    spoil(folder, name, content)
    with pytest.raises(InputError, match=words) as caught:
        open_recorded({"folder": str(folder)}, context())
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("spoiled", "words"),
    [(b"", "not an image"), (b"nonsense", "not an image"), ("8 bits", "6 x 8 uint8 .should be 6 x 8 uint16")],
)
def test_a_damaged_image_is_a_device_error(folder, spoiled, words):
    path = folder / "depth/5.000000.png"
    data = cv2.imencode(".png", np.zeros((6, 8), np.uint8))[1].tobytes() if spoiled == "8 bits" else spoiled
    path.write_bytes(data)
    with pytest.raises(DeviceError, match=words):
        read_recording(folder)[0].pixels()


def test_no_folder_is_said_so(tmp_path):
    with pytest.raises(InputError, match="no such folder"):
        open_recorded({"folder": str(tmp_path / "nowhere")}, context())
