import numpy as np
import pytest
from scripted_mission import LANDMARKS, apartment, drive, finished

from zavis_bt.recording import draw_map
from zavis_bt.recording.canvas import GRID_COLOURS, Canvas, known_bounds
from zavis_bt.recording.labels import Label, place
from zavis_bt.recording.marks import CANDIDATE, FOUND, START, VIEWPOINT, draw_visited, landmark_colour, time_colours
from zavis_bt.types import FREE, OCCUPIED, UNKNOWN, GridMap, Landmark, Pose2D


def contains(picture, colour):
    return bool((picture == np.array(colour, dtype=np.uint8)).all(axis=2).any())


def test_cells_are_drawn_where_they_are():
    grid = apartment()
    canvas = Canvas((0.0, 0.0, 8.0, 6.0), 40.0)
    canvas.draw_grid(grid)
    picture = canvas.finish()
    points = np.random.default_rng(0).uniform((0.1, 0.1), (7.9, 5.9), (400, 2))
    pixels = np.floor(canvas.to_pixels(points)).astype(int)
    inner = [abs((p / 0.05) % 1 - 0.5).max() < 0.2 for p in points + 0.2]  # away from the edges of cells
    for point, (u, v) in zip(points[inner], pixels[inner], strict=True):
        assert tuple(picture[v, u]) == GRID_COLOURS[grid.state_at(*point)]


def test_north_is_up_and_east_is_right():
    canvas = Canvas((0.0, 0.0, 4.0, 2.0), 10.0)
    np.testing.assert_allclose(canvas.to_pixels(np.array([[0.0, 2.0], [4.0, 0.0]])), [[0.0, 0.0], [40.0, 20.0]])


def test_only_the_known_part_is_shown():
    half, whole = (known_bounds(apartment(share), np.empty((0, 2)), 0.0) for share in (0.5, 1.0))
    assert half[2] < 4.4 < 8.0 < whole[2]


def test_everything_given_is_drawn():
    mission = finished()
    picture = draw_map(
        mission.grid,
        trajectory=mission.trajectory,
        start=Pose2D(1.2, 1.0),
        landmarks=mission.landmarks,
        visited=[viewpoint.pose for viewpoint in mission.visited],
        frontiers=np.array([[4.6, 2.4]]),
        candidates=[candidate.position for candidate in mission.candidates],
        found=mission.found.position,
        target="alarm clock",
        title="a title",
    )
    assert picture.dtype == np.uint8
    assert picture.shape[2] == 3
    for colour in (GRID_COLOURS[FREE], GRID_COLOURS[OCCUPIED], FOUND, CANDIDATE, VIEWPOINT, START):
        assert contains(picture, colour)


@pytest.mark.parametrize("shape", [(0, 0), (1, 1), (3, 400), (2, 2)])
def test_empty_and_odd_maps_can_be_drawn(shape):
    picture = draw_map(GridMap(np.full(shape, UNKNOWN, dtype=np.int8), 0.05, (0.0, 0.0)))
    assert contains(picture, GRID_COLOURS[UNKNOWN])


def test_bare_map_has_no_marks():
    assert not contains(draw_map(apartment()), VIEWPOINT)


def test_picture_is_the_same_every_time():
    np.testing.assert_array_equal(*(draw_map(apartment(), trajectory=drive(50), landmarks=LANDMARKS) for _ in range(2)))


def test_drawing_leaves_the_values_alone():
    grid, path = apartment(), drive(50)
    before = path.copy()
    draw_map(grid, trajectory=path)
    np.testing.assert_array_equal(path, before)


def test_labels_of_marks_at_one_place_do_not_overlap():
    labels = [Label(f"landmark {i}", (200.0 + i, 150.0), 5.0) for i in range(6)]
    rectangles = place(labels, np.empty((0, 4)), (400, 300))
    for i, a in enumerate(rectangles):
        for b in rectangles[:i]:
            assert (np.minimum(a[2:], b[2:]) <= np.maximum(a[:2], b[:2]) + 1e-9).any()


@pytest.mark.parametrize("anchor", [(0.0, 0.0), (400.0, 300.0), (400.0, 0.0)])
def test_labels_stay_inside_the_picture(anchor):
    ((u0, v0, u1, v1),) = place([Label("dining table", anchor, 5.0)], np.empty((0, 4)), (400, 300))
    assert u0 >= 0 <= v0
    assert u1 <= 400
    assert v1 <= 300


def test_colour_of_a_landmark_tells_how_sure_its_name_is():
    sure, unsure = (Landmark(0, (("a", p), ("b", 1 - p)), (0, 0, 0), 0.5, 1) for p in (1.0, 0.5))
    assert landmark_colour(sure)[1] > landmark_colour(sure)[0]
    assert landmark_colour(unsure)[0] > landmark_colour(unsure)[1]


def test_colours_of_time_run_from_blue_to_orange():
    early, late = time_colours(20)[[0, -1]]
    assert early[2] > early[0]
    assert late[0] > late[2]


def test_viewpoints_at_one_place_share_a_disc_and_all_numbers_are_there():
    canvas = Canvas((0.0, 0.0, 4.0, 4.0), 100.0)
    marks = draw_visited(canvas, [Pose2D(1.0, 1.0, yaw) for yaw in (0.0, 1.0, 2.0)] + [Pose2D(3.0, 3.0)])
    assert [(mark.number, mark.label and mark.label.text) for mark in marks] == [("1", "2, 3"), ("4", None)]
