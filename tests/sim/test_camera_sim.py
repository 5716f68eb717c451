from __future__ import annotations

import numpy as np
from seen_worlds import camera_spec, piece, room

from sim.camera import SimCamera
from sim.scene import Scene
from zavis_bt.geometry import aim, transform_camera_to_map
from zavis_bt.types import Pose2D


def test_a_frame_knows_where_and_when_it_was_taken():
    spec = camera_spec()
    frame = SimCamera(Scene.of(room()), spec).capture(Pose2D(2.0, 1.0, 0.5), 0.3, -0.2, 12.5)
    assert frame.stamp == 12.5
    assert frame.intrinsics is spec.intrinsics
    expected = transform_camera_to_map(Pose2D(2.0, 1.0, 0.5), 0.3, -0.2, spec)
    np.testing.assert_array_equal(frame.transform_camera_to_map, expected)


def test_nothing_is_rendered_until_it_is_asked_for():
    frame = SimCamera(Scene.of(room()), camera_spec()).capture(Pose2D(2.0, 1.0), 0.0, 0.0, 0.0)
    frame.depth_at(np.array([[10, 10]]))
    assert frame.instances == ()
    assert "_pixels" not in frame.__dict__
    assert frame.rgb is frame.rgb


def test_aiming_at_a_piece_of_furniture_puts_it_in_the_middle():
    dresser, spec, base = piece("dresser", 4.0, 3.0, 1.0), camera_spec(), Pose2D(1.0, 1.0, 2.0)
    pan, tilt = aim(base, spec, (4.0, 3.0, 0.5))
    (view,) = SimCamera(Scene.of(room((dresser,))), spec).capture(base, pan, tilt, 0.0).instances
    assert abs((view.box.x0 + view.box.x1) / 2 - 320) < 10
    assert abs((view.box.y0 + view.box.y1) / 2 - 240) < 30


def test_frames_of_one_place_are_alike():
    camera = SimCamera(Scene.of(room((piece("bed", 3.0, 2.0, 0.5),))), camera_spec(160, 120))
    one, two = (camera.capture(Pose2D(1.0, 2.0), 0.1, -0.1, stamp) for stamp in (0.0, 1.0))
    assert np.array_equal(one.rgb, two.rgb)
    assert np.array_equal(one.depth, two.depth)
    assert one.instances == two.instances
