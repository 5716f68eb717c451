"""`zavis camera`: calibrate cameras, save what they see."""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, cast

import typer

from zavis_bt.errors import InputError

if TYPE_CHECKING:
    from drivers.camera.calibrate import Views
    from drivers.camera.calibration_pictures import Image
    from drivers.camera.stills import Still

_JUDGEMENTS = (
    (0.3, "very good"),
    (0.6, "good"),
    (1.0, "usable; more views, a flatter board or a sharper focus would help"),
)
_POOR = "poor: is the board flat, its size in inner corners right, and every view sharp?"
_COVERED = 0.6  # share of the image from which on its edges are known

app = typer.Typer(help="Calibrate cameras, save what they see.", no_args_is_help=True)


@app.command()
def calibrate(
    sources: Annotated[
        list[str],
        typer.Argument(
            metavar="SOURCE [RIGHT]", help="Folder of images, webcam's number, video or stream; two: a stereo pair."
        ),
    ],
    square: Annotated[float, typer.Option(min=0.001, max=1.0, help="Side of a square [m].")],
    out: Annotated[Path, typer.Option(help="File to write, in OpenCV's YAML.")],
    board: Annotated[str, typer.Option(help="Inner corners along both sides of the board.")] = "9x6",
    side_by_side: Annotated[bool, typer.Option("--side-by-side", help="Images show left and right eye.")] = False,
    views: Annotated[int, typer.Option(min=6, max=1000, help="From a camera: stop after so many useful views.")] = 20,
    every: Annotated[float, typer.Option(min=0.1, help="From a camera: time between two views [s].")] = 1.0,
    pictures: Annotated[
        Path | None, typer.Option(help="Folder for pictures of what was found; by default beside the file.")
    ] = None,
) -> None:
    """Measure a camera's lens, or a stereo pair, with a chessboard held before it in many places and tilts."""
    from drivers.camera.calibrate import Views
    from drivers.camera.chessboard import parse_board
    from drivers.camera.stills import stills

    if len(sources) > 2 or (side_by_side and len(sources) > 1):
        raise InputError("calibrate: give one source, or two for a stereo pair without --side-by-side")
    if not out.parent.is_dir():
        raise InputError(f"--out: there is no folder {out.parent} (make it first)")
    folder = pictures or out.parent / f"{out.stem}_pictures"
    found = Views(parse_board(board, square), 2 if side_by_side else len(sources))
    is_pair = found.cameras == 2
    enough = None if Path(sources[0]).is_dir() else views
    sample = _collect(found, stills(sources, side_by_side, every), enough, folder)
    (_finish_pair if is_pair else _finish_one)(found, sample, out, folder)


@app.command()
def grab(
    robot: Annotated[str, typer.Argument(metavar="ROBOT", help="Robot file.")],
    out: Annotated[Path, typer.Option(help="Folder to write to; must be empty or new.")] = Path("grabbed"),
    frames: Annotated[int, typer.Option(min=1, help="How many.")] = 1,
) -> None:
    """Save what a robot's camera sees as PNG images, a recording that the driver 'recorded' plays back."""
    from drivers.camera import record
    from zavis_bt.cli.files import load_robot_file
    from zavis_bt.mission import WallClock
    from zavis_bt.mission.device_robot import open_device
    from zavis_bt.protocols import Camera

    with closing(open_device(load_robot_file(robot), "camera", WallClock())) as device:
        record(cast(Camera, device).frame, out, frames)
    print(f"{out}: {frames} frame{'s' * (frames != 1)} (colour in rgb/, depth in millimetres in depth/)")


def _collect(found: Views, stills: Iterable[Still], enough: int | None, folder: Path) -> list[Image]:
    """Look through images until there are enough, or no more; return those of the first view accepted."""
    from drivers.camera.calibration_pictures import draw_corners, save_picture

    sample: list[Image] = []
    for name, images in stills:
        reason = "is no image" if images is None else found.add(name, images)
        if reason or images is None:
            print(f"{name}: left out: {reason}")
            continue
        number = len(found.accepted)
        print(f"{name}: view {number}, {found.coverage:.0%} of the image covered")
        picture = draw_corners(images, found.accepted[-1].corners, found.board)
        save_picture(folder / f"corners_{number:03d}.png", picture)
        sample = sample or images
        if number == enough:
            break
    return sample


def _finish_one(found: Views, sample: list[Image], out: Path, folder: Path) -> None:
    from drivers.camera.calibrate import calibrate_camera
    from drivers.camera.calibration_file import write_calibration
    from drivers.camera.calibration_pictures import draw_undistorted, save_picture

    calibration, dropped = calibrate_camera(found)
    write_calibration(out, calibration)
    save_picture(folder / "undistorted.png", draw_undistorted(sample[0], calibration))
    m = calibration.matrix
    _print_result(found, dropped, calibration.rms)
    print(f"focal lengths {m[0, 0]:.1f} and {m[1, 1]:.1f} px, principal point {m[0, 2]:.1f}, {m[1, 2]:.1f} px")
    print(f"{out}: written; see {folder / 'undistorted.png'}: what is straight must be straight on the right")


def _finish_pair(found: Views, sample: list[Image], out: Path, folder: Path) -> None:
    from drivers.camera.calibrate import calibrate_pair
    from drivers.camera.calibration_file import write_stereo
    from drivers.camera.calibration_pictures import draw_rectified, save_picture

    calibration, dropped = calibrate_pair(found)
    write_stereo(out, calibration)
    save_picture(folder / "rectified.png", draw_rectified(sample[0], sample[1], calibration))
    _print_result(found, dropped, calibration.rms)
    print(f"baseline {1000 * calibration.baseline:.1f} mm, focal length {calibration.P1[0, 0]:.1f} px")
    print(f"{out}: written; see {folder / 'rectified.png'}: each line must meet the same thing on both sides")


def _print_result(found: Views, dropped: dict[str, float], rms: float) -> None:
    for name, error in dropped.items():
        print(f"{name}: left out: fits far worse than the others ({error:.2f} px)")
    meaning = next((words for limit, words in _JUDGEMENTS if rms <= limit), _POOR)
    print(f"RMS reprojection error {rms:.2f} px over {len(found.accepted)} views: {meaning}")
    if found.coverage < _COVERED:
        print(f"the boards cover {found.coverage:.0%} of the image: hold some near its edges and corners")
