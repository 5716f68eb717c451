"""`zavis sim`: the simulator as hardware."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from zavis_bt.errors import DeviceError, InputError

if TYPE_CHECKING:
    from sim.devices.serve import Places, SimulatedDevices
    from sim.noise import NoiseSettings
    from sim.world import World
    from zavis_bt.types import Pose2D

PROFILE = "pioneer3at_sim"
_CAN = "udp_multicast:239.74.163.2"

app = typer.Typer(help="The simulator as hardware.", no_args_is_help=True)


@app.command()
def serve(
    world: Annotated[str, typer.Argument(metavar="WORLD", help="A world file, or the name of a built-in world.")],
    robot: Annotated[str, typer.Option("--robot", "-r", help="Robot file or profile: the model.")] = PROFILE,
    start: Annotated[str | None, typer.Option(help="Start x,y,yaw in m, m, degrees; else one of the world's.")] = None,
    seed: Annotated[int, typer.Option(min=0, help="Of all randomness; also chooses among the world's starts.")] = 0,
    host: Annotated[str, typer.Option(help="Address to listen at; 0.0.0.0 for other computers.")] = "127.0.0.1",
    base_port: Annotated[int, typer.Option(min=0, max=65535, help="TCP port of the base; 0 = any.")] = 8101,
    lidar_port: Annotated[int, typer.Option(min=0, max=65535, help="TCP port of the LiDAR.")] = 10940,
    camera_port: Annotated[int, typer.Option(min=0, max=65535, help="TCP port of the camera.")] = 8102,
    can: Annotated[
        str, typer.Option(help="CAN bus of the pan-tilt unit: KIND:CHANNEL[:PORT] by python-can's names.")
    ] = _CAN,
    watchdog: Annotated[
        float, typer.Option(min=0, help="The base stops after so long a silence [s]; 0 = never.")
    ] = 1.0,
    serial: Annotated[bool, typer.Option("--serial", help="Offer the base at a pseudo-terminal, too.")] = False,
    range_noise: Annotated[float, typer.Option(min=0, help="Standard deviation of LiDAR ranges [m].")] = 0.0,
    odometry_noise: Annotated[float, typer.Option(min=0, help="Odometry's error after a metre, e.g. 0.02.")] = 0.0,
    write_robot: Annotated[Path | None, typer.Option(help="Write a robot file that fits.")] = None,
    view: Annotated[bool, typer.Option("--view", help="Show what is really so live in the browser.")] = False,
) -> None:
    """Simulate a robot's devices behind their real wire protocols, until Ctrl-C. Type 'help' to break them by hand."""
    from rich.console import Console

    from sim.devices.robot_file import write_robot_file
    from sim.devices.serve import SimulatedDevices
    from sim.world_file import load_world
    from sim.worlds import resolve_world
    from zavis_bt.cli.files import load_robot_spec
    from zavis_bt.cli.serving import attend, introduce

    place, spec = load_world(resolve_world(world)), load_robot_spec(robot)
    pose = _start(place, start, seed)
    try:
        devices = SimulatedDevices(
            place,
            spec,
            pose,
            seed=seed,
            noise=_noise(range_noise, odometry_noise),
            places=_places(host, base_port, lidar_port, camera_port, can),
            watchdog=watchdog,
            serial=serial,
        )
    except DeviceError as error:
        raise DeviceError(f"{error}; see --base-port, --lidar-port, --camera-port (0 = any free one)") from error
    console = Console(highlight=False)
    with devices:
        if write_robot is not None:
            write_robot_file(write_robot, spec, devices.settings())
        introduce(devices, place, pose, _robot_to_name(write_robot, devices, robot), console)
        attend(devices, place, console, view=view)


@app.command()
def frames(
    out: Annotated[Path, typer.Argument(metavar="OUT", help="New folder: images/ and annotations.json.")],
    count: Annotated[int, typer.Option("--count", "-n", min=1, help="Images.")] = 1000,
    seed: Annotated[int, typer.Option(min=0, help="Of all randomness; image k of a seed is always the same.")] = 0,
    width: Annotated[int, typer.Option(min=16, max=4096, help="Of the images [px]; height is 3/4 of it.")] = 640,
    workers: Annotated[int, typer.Option("--workers", "-j", min=1, help="Processes.")] = 1,
    without: Annotated[list[str] | None, typer.Option(help="Never draw this category; repeat for more.")] = None,
    also: Annotated[list[str] | None, typer.Option(help="Draw this category more often; repeat for more.")] = None,
) -> None:
    """Draw random rooms and label what they show: a data set in COCO's form to train and judge eyes with."""
    from sim.labelled_frames import FrameRecipe, chosen_categories, write_frames

    categories = chosen_categories(without or (), also or ())
    recipe = FrameRecipe(seed=seed, width=width, categories=categories)
    _follow(write_frames(out, count, recipe, workers), count)
    typer.echo(f"{out}: {count} images of {len(set(categories))} categories")


def _follow(written: Iterable[int], count: int) -> None:
    """Draw a data set, with a bar at a terminal."""
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    console = Console(stderr=True)
    columns = (TextColumn("drawing"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as bar:
        task = bar.add_task("", total=count)
        for done in written:
            bar.update(task, completed=done)


def _start(world: World, start: str | None, seed: int) -> Pose2D:
    from zavis_bt.cli.files import parse_start

    if start is not None:
        return parse_start(start)
    if not world.starts:
        raise InputError(f"{world.name}: the world names no start (give --start x,y,yaw)")
    return world.starts[seed % len(world.starts)]


def _noise(ranges: float, odometry: float) -> NoiseSettings:
    """Return noise with this standard deviation of ranges [m], and of the odometry after a metre or a radian."""
    from sim.noise import NoiseSettings

    variance = odometry**2
    return NoiseSettings(
        range_sigma=ranges,
        rotation_per_radian=variance,
        rotation_per_metre=variance,
        distance_per_metre=variance,
        distance_per_radian=variance,
    )


def _places(host: str, base: int, lidar: int, camera: int, can: str) -> Places:
    from sim.devices.serve import Places

    interface, sign, channel = can.partition(":")
    if not (interface and sign and channel):
        raise InputError(f"--can: '{can}' is no bus (KIND:CHANNEL, e.g. {_CAN} or socketcan:vcan0)")
    group, _, port = channel.rpartition(":")
    if interface == "udp_multicast" and "." in group and port.isdecimal():
        return Places(host, base, lidar, camera, interface, group, {"port": int(port)})
    return Places(host, base, lidar, camera, interface, channel)


def _robot_to_name(written: Path | None, devices: SimulatedDevices, robot: str) -> str | None:
    """Return what --robot must say so that the drivers find these devices; None if no file is known."""
    from zavis_bt.cli.files import load_robot_file

    if written is not None:
        return str(written)
    for name in (robot, PROFILE):
        known = {kind: dict(device.settings) for kind, device in load_robot_file(name).devices.items()}
        if known == {kind: device["settings"] for kind, device in devices.settings().items()}:
            return name
    return None
