from __future__ import annotations

import math

import numpy as np
import pytest
from seen_worlds import camera_spec, look, piece, room, thing

from sim.appearance import RoomLook
from sim.camera import SimCamera
from sim.render_paint import COLOURS, basic_colour
from sim.scene import Scene
from zavis_bt.types import Box, Pose2D


@pytest.fixture(scope="module")
def world():
    furniture = (piece("dresser", 3.0, 2.5, 1.2, yaw=0.3), piece("desk", 2.6, 1.4, 0.75, yaw=1.0, size=1.0))
    objects = (thing("mug", 2.6, 1.4, 0.75, on="desk_1"), thing("book", 2.95, 2.45, 0.8, on="dresser_1"))
    return room(furniture, objects)


@pytest.mark.parametrize("tilt", [0.2, 0.0, -0.5])
def test_single_depths_equal_the_image(world, tilt):
    frame = look(world, 1.0, 2.0, tilt=tilt)
    rows, cols = np.mgrid[0:480:7, 0:640:7]
    pixels = np.column_stack((cols.ravel(), rows.ravel()))
    assert np.array_equal(look(world, 1.0, 2.0, tilt=tilt).depth_at(pixels), frame.depth[pixels[:, 1], pixels[:, 0]])


def test_depth_is_measured_along_the_optical_axis():
    frame = look(room(), 1.0, 2.0)
    assert frame.depth[240, 320] == pytest.approx(5.0, rel=1e-6)
    assert frame.depth[240, 520] == pytest.approx(5.0, rel=1e-6)  # the wall is parallel to the image


def test_depths_out_of_range_read_zero():
    scene = Scene.of(room((piece("dresser", 1.5, 2.0, 1.2),)))
    frame = SimCamera(scene, camera_spec(depth_max=4.0)).capture(Pose2D(1.0, 2.0), 0.0, 0.0, 0.0)
    assert frame.depth[240, 320] == 0.0  # 0.2 m away
    assert frame.depth[240, 5] == 0.0 or frame.depth[240, 5] <= 4.0
    assert look(room(), 1.0, 2.0).depth[0, 320] == 0.0 or look(room(), 1.0, 2.0).depth[0, 320] <= 8.0
    far = SimCamera(Scene.of(room()), camera_spec(depth_max=4.0)).capture(Pose2D(1.0, 2.0), 0.0, 0.0, 0.0)
    assert far.depth[240, 320] == 0.0  # 5 m away


def test_images_have_the_cameras_shape_and_type(world):
    frame = SimCamera(Scene.of(world), camera_spec(160, 120)).capture(Pose2D(1.0, 2.0), 0.3, -0.2, 0.0)
    assert frame.rgb.shape == (120, 160, 3)
    assert frame.rgb.dtype == np.uint8
    assert frame.depth.shape == (120, 160)
    assert frame.depth.dtype == np.float32


def test_a_patch_is_the_same_with_and_without_the_whole_image(world):
    box = Box(100.3, 120.7, 333.2, 281.0)
    lazy, rendered = look(world, 1.0, 2.0), look(world, 1.0, 2.0)
    assert rendered.rgb.any()
    assert np.array_equal(lazy.crop(box), rendered.crop(box))
    assert "_picture" not in lazy.__dict__


def test_a_named_colour_is_painted():
    red = thing("box", 2.0, 2.0, 0.7, colour="red")
    patch = look(room((), (red,)), 1.0, 2.0).rgb[240, 320].astype(int)
    assert patch[0] > 2 * max(patch[1], patch[2])


def test_colours_have_names_in_two_spellings():
    assert basic_colour("gray") == "grey"
    assert basic_colour("mug") is None
    assert len(COLOURS) >= 10


def test_walls_and_floor_differ():
    rgb = look(room(), 1.0, 2.0, tilt=-0.3).rgb.astype(int)
    assert np.abs(rgb[5, 320] - rgb[475, 320]).max() > 20


def test_faces_turned_to_the_lamp_are_brighter():
    box = room((piece("obstacle", 2.0, 2.0, 0.7),))
    rgb = {}
    for name, lamp in (("ahead", (-1.0, 0.0, 0.2)), ("behind", (1.0, 0.0, 0.2))):
        scene = Scene.of(box, RoomLook(lamp=lamp))
        frame = SimCamera(scene, camera_spec()).capture(Pose2D(1.0, 2.0), 0.0, -0.4, 0.0)
        rgb[name] = frame.rgb[frame.surfaces == 0].mean()
    assert rgb["ahead"] > 1.2 * rgb["behind"]


def test_looking_steeply_up_sees_nothing():
    frame = look(room(), 3.0, 2.0, tilt=math.radians(85))
    assert (frame.depth == 0).mean() > 0.9
