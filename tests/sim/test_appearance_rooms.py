from __future__ import annotations

import math

import numpy as np
import pytest
from seen_worlds import look, piece, room, snapshot, thing

from sim.appearance import (
    CameraEffects,
    RoomLook,
    random_frame,
    random_scene,
    random_standing_frame,
    random_world,
    shape_of,
)
from sim.appearance.facing import orientations
from sim.camera import SimCamera
from sim.render_labels import pixel_boxes
from sim.scene import Scene
from sim.world import Furniture
from zavis_bt.types import FREE, CameraIntrinsics, Pose2D

CAMERA = CameraIntrinsics.from_fov(96, 72, math.radians(60))


def view(seed: int):
    rng = np.random.default_rng(seed)
    return random_frame(rng, random_scene(rng), CAMERA)


def test_the_same_seed_gives_the_same_view_and_another_one_another():
    assert np.array_equal(view(5).rgb, view(5).rgb)
    assert not np.array_equal(view(5).rgb, view(6).rgb)


def test_views_show_things_and_their_labels():
    seen = [view(seed) for seed in range(12)]
    assert np.mean([len(frame.labels) for frame in seen]) > 2
    for frame in seen:
        for label in frame.labels:
            pixels = np.argwhere(frame.surfaces == label.number)
            assert label.pixels == len(pixels)
            assert (label.box.y0, label.box.x0) == tuple(pixels.min(axis=0))
            assert (label.box.y1, label.box.x1) == tuple(pixels.max(axis=0) + 1)
            assert 0 < label.visible_fraction <= 1
            assert label.category


@pytest.mark.parametrize("seed", range(4))
def test_single_depths_equal_the_image_in_random_rooms(seed):
    frame = view(seed)
    rows, cols = np.mgrid[0:72:3, 0:96:3]
    pixels = np.column_stack((cols.ravel(), rows.ravel()))
    assert np.array_equal(view(seed).depth_at(pixels), frame.depth[pixels[:, 1], pixels[:, 0]])


@pytest.mark.parametrize("seed", range(4))
def test_surfaces_and_depths_agree(seed):
    frame = view(seed)
    scene, origin = frame._scene, frame.transform_camera_to_map[:3, 3]
    rows, cols = np.nonzero((frame.surfaces >= 0) & (frame.depth > 0))
    rays = np.column_stack(
        ((cols + 0.5 - CAMERA.cx) / CAMERA.fx, (rows + 0.5 - CAMERA.cy) / CAMERA.fy, np.ones(len(rows)))
    )
    points = origin + frame.depth[rows, cols, None] * (rays @ frame.transform_camera_to_map[:3, :3].T)
    balls = scene.parts.spheres[frame.surfaces[rows, cols]]
    assert (np.linalg.norm(points - balls[:, :3], axis=1) <= balls[:, 3] * 1.0001 + 1e-6).all()


def test_half_hidden_things_say_so():
    world = room((piece("obstacle", 2.0, 1.75, 1.5, size=0.5),), (thing("box", 3.0, 2.0, 0.7),))
    (label,) = (label for label in look(world, 1.0, 2.0).labels if label.category == "box")
    alone = look(room((), (thing("box", 3.0, 2.0, 0.7),)), 1.0, 2.0).labels[0]
    assert label.visible_fraction == pytest.approx(label.pixels / alone.pixels, abs=0.01)
    assert 0.2 < label.visible_fraction < 0.8


def test_boxes_of_pixels_are_tight():
    surfaces = np.full((6, 8), -1, dtype=np.int32)
    surfaces[2:4, 3:7] = 1
    boxes, pixels = pixel_boxes(surfaces, 3)
    assert boxes.tolist() == [[0, 0, 0, 0], [3, 2, 7, 4], [0, 0, 0, 0]]
    assert pixels.tolist() == [0, 8, 0]


def test_labels_name_the_colour_that_is_painted():
    labels = look(room((), (thing("box", 2.0, 2.0, 0.7, colour="blue"),)), 1.0, 2.0).labels
    assert [label.colour for label in labels] == ["blue"]


def test_furniture_turns_its_back_to_the_wall():
    for x, y, yaw in ((0.3, 2.0, math.pi / 2), (5.7, 2.0, math.pi / 2), (3.0, 0.3, 0.0), (3.0, 3.7, 0.0)):
        sofa = Furniture("sofa_1", "sofa", x, y, yaw, 1.6, 0.6, 0.45)
        parts = Scene.of(room((sofa,))).parts
        high = parts.frames[:, 2] > 0.5  # the back stands out above the seat
        away = (parts.frames[high, :2] - (x, y)).mean(axis=0)
        assert away @ (np.array([x, y]) - (3.0, 2.0)) > 0


def test_rooms_differ_in_walls_floor_and_light():
    frames = []
    for seed in range(4):
        scene = Scene.of(room(), RoomLook.drawn(np.random.default_rng(seed)))
        frames.append(scene.room_paint.tolist())
    assert len({str(frame) for frame in frames}) == 4


def test_random_worlds_stay_within_their_room_and_categories():
    world = random_world(np.random.default_rng(2), ["mug", "desk", "book"])
    assert {one.category for one in (*world.furniture, *world.objects)} <= {"mug", "desk", "book"}
    rows, cols = world.grid.shape
    for one in world.objects:
        assert 0 < one.x < cols * 0.05
        assert 0 < one.y < rows * 0.05
        assert one.on is None or shape_of(next(p for p in world.furniture if p.id == one.on).category).bears


def test_random_furniture_shows_its_front():
    ahead = []
    for seed in range(30):
        scene = random_scene(np.random.default_rng(seed), ["washing machine", "fridge", "toilet", "sofa"])
        boxes = np.array([(f.x, f.y, 0, f.length, f.width, f.height, f.yaw) for f in scene.world.furniture])
        shapes = [shape_of(f.category) for f in scene.world.furniture]
        turns = orientations(scene.world, boxes, shapes)
        for box, turn in zip(boxes, turns, strict=True):
            cos, sin = math.cos(box[6]), math.sin(box[6])
            front = np.array([[cos, -sin], [sin, cos]]) @ -turn[:2, 1]
            reach = np.abs(turn[:2, 1]) @ box[3:5] / 2 + 0.5
            ahead.append(scene.world.grid.state_at(*(box[:2] + reach * front)) == FREE)
    assert len(ahead) > 80
    assert np.mean(ahead) > 0.95


def test_sizes_and_proportions_of_a_category_vary_by_a_fifth():
    vases = [
        np.log(one.size)
        for seed in range(25)
        for one in random_world(np.random.default_rng(seed), ["vase", "desk"]).objects
    ]
    sides = np.array(vases) - np.log(shape_of("vase").size)
    assert abs(sides.mean()) < 0.1
    assert 0.12 < sides.mean(axis=1).std() < 0.3
    assert 0.12 < sides[:, 2].std() < 0.35


def test_who_stands_before_furniture_sees_parts_of_it_and_aims_at_nothing():
    rng = np.random.default_rng(8)
    cut, middles = 0, []
    for _ in range(40):
        scene = random_scene(rng, ["bed", "sofa", "desk", "mug"])
        frame = random_standing_frame(rng, scene, CAMERA)
        x, y = frame.transform_camera_to_map[:2, 3]
        assert scene.world.grid.state_at(x, y) == FREE
        pieces = [one for one in frame.instances if one.is_furniture]
        cut += any(one.full_box.x0 < 0 or one.full_box.x1 > CAMERA.width for one in pieces)
        middles += [(one.box.x0 + one.box.x1) / 2 / CAMERA.width for one in pieces]
    assert cut > 20
    assert np.std(middles) > 0.15


def test_a_room_without_furniture_can_be_looked_at():
    rng = np.random.default_rng(4)
    assert random_standing_frame(rng, random_scene(rng, ["mug"]), CAMERA).labels


def test_what_grows_has_its_own_colours():
    names = ["orange", "tomato", "lettuce", "desk"]
    seen: dict[str, set[str | None]] = {name: set() for name in names}
    for seed in range(20):
        scene = random_scene(np.random.default_rng(seed), names)
        things = (*scene.world.furniture, *scene.world.objects)
        for one, drawn in zip(things, scene.looks, strict=True):
            seen[one.category].add(drawn.colour)
    assert (seen["orange"], seen["tomato"], seen["lettuce"]) == ({"orange"}, {"red"}, {"green"})
    assert len(seen["desk"]) > 5


def test_no_effects_leave_the_image_as_it_is():
    image = view(1).rgb
    assert np.array_equal(CameraEffects().apply(image, np.random.default_rng(0)), image)


def test_effects_blur_darken_and_add_noise():
    image, rng = view(1).rgb, np.random.default_rng(0)
    blurred = CameraEffects(defocus=2.0).apply(image, rng)
    assert np.abs(np.diff(blurred.astype(int), axis=1)).mean() < 0.8 * np.abs(np.diff(image.astype(int), axis=1)).mean()
    streaked = CameraEffects(motion=7.0).apply(image, rng).astype(int)
    assert np.abs(np.diff(streaked, axis=1)).sum() < np.abs(np.diff(image.astype(int), axis=1)).sum()
    assert CameraEffects(exposure=0.5).apply(image, rng).mean() == pytest.approx(image.mean() / 2, abs=1)
    noisy = CameraEffects(noise=8.0).apply(image, rng).astype(int) - image
    assert 2 < noisy.std() < 9
    assert CameraEffects(vignette=0.5).apply(image, rng)[0, 0].mean() < 0.7 * image[0, 0].mean() + 1
    drawn = CameraEffects.drawn(rng, 96).apply(image, rng)
    assert drawn.shape == image.shape
    assert drawn.dtype == np.uint8


def test_walls_may_be_papered_and_floors_boarded():
    seen = set()
    for seed in range(12):
        drawn = RoomLook.drawn(np.random.default_rng(seed))
        seen.add(drawn.wall.pattern)
        frame = SimCamera(Scene.of(room(), drawn), snapshot_spec()).capture(Pose2D(1.0, 2.0), 0.0, -0.3, 0.0)
        assert frame.rgb.mean() > 20
    assert len(seen) > 2


def snapshot_spec():
    from seen_worlds import camera_spec

    return camera_spec(96, 72)


def test_gaps_show_what_is_behind():
    chair = piece("chair", 2.0, 2.0, 0.9, size=0.5)
    frame = snapshot(room((chair,)), 1.0, 2.0, tilt=-0.4, size=(192, 144))
    (label,) = frame.labels
    inside = frame.surfaces[int(label.box.y0) : int(label.box.y1), int(label.box.x0) : int(label.box.x1)]
    assert 0.2 < (inside == 0).mean() < 0.85
    behind = frame.depth[frame.surfaces < 0]
    assert behind.max() > 2.0
