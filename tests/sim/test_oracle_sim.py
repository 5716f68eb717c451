from __future__ import annotations

import pytest
from seen_worlds import look, piece, room, seen, thing

from sim.oracle import Oracle, shows
from zavis_bt.protocols import Human
from zavis_bt.types import Answer, Box, Candidate


class HandClock:
    def __init__(self) -> None:
        self.time = 0.0

    def now(self) -> float:
        return self.time

    def wait_until(self, stamp: float) -> None:
        self.time = max(self.time, stamp)


def candidate(frame, box: Box) -> Candidate:
    return Candidate("mug", 30.0, box, (0.0, 0.0, 0.0), frame)


@pytest.fixture
def frame():
    mugs = (thing("mug", 2.0, 1.8, 0.85, colour="red"), thing("mug", 2.0, 2.2, 0.85, colour="black", number=2))
    return look(room((), mugs), 1.0, 2.0)


def box_of(frame, instance: str) -> Box:
    view = seen(frame, instance)
    assert view is not None
    return view.box


def ask(oracle: Human, *candidates: Candidate) -> Answer:
    return oracle.ask("mug", candidates).result()


def test_the_first_candidate_that_shows_the_target_is_accepted(frame):
    wrong, right = candidate(frame, Box(0, 0, 50, 50)), candidate(frame, box_of(frame, "mug_1"))
    assert ask(Oracle(["mug_1"]), wrong, right, right).accepted == 1
    assert ask(Oracle(["mug_1"]), wrong).accepted is None
    assert ask(Oracle(["mug_1"])).accepted is None


def test_another_instance_of_the_kind_is_not_the_target(frame):
    other = candidate(frame, box_of(frame, "mug_2"))
    assert ask(Oracle(["mug_1"]), other).accepted is None
    assert ask(Oracle("mug"), other).accepted == 0


def test_a_colour_and_a_kind_name_a_target(frame):
    red, black = candidate(frame, box_of(frame, "mug_1")), candidate(frame, box_of(frame, "mug_2"))
    assert ask(Oracle("Black mug"), red, black).accepted == 1


@pytest.mark.parametrize(
    ("box", "yes"),
    [
        (Box(0, 0, 100, 100), True),
        (Box(0, 0, 100, 31), True),  # IoU 0.31
        (Box(0, 0, 100, 29), False),  # IoU 0.29 = IoA
        (Box(-500, -500, 500, 500), True),  # IoU 0.01 but all of the target
        (Box(-900, 0, 49, 100), False),  # IoA 0.49
        (Box(-900, 0, 51, 100), True),  # IoA 0.51
        (Box(200, 200, 300, 300), False),
    ],
)
def test_a_box_shows_the_target_by_iou_or_by_the_share_of_the_true_box(box, yes):
    assert shows(box, Box(0, 0, 100, 100)) is yes


def test_a_hidden_target_is_not_confirmed():
    world = room((piece("dresser", 2.5, 2.0, 1.2),), (thing("mug", 3.0, 2.0, 0.8),))
    everything = candidate(look(world, 1.0, 2.0), Box(0, 0, 640, 480))
    assert ask(Oracle(["mug_1"]), everything).accepted is None


def test_an_answer_without_delay_is_there_at_once(frame):
    assert Oracle(["mug_1"]).ask("mug", [candidate(frame, box_of(frame, "mug_1"))]).done()


def test_an_answer_takes_its_time_on_the_clock(frame):
    clock = HandClock()
    job = Oracle(["mug_1"], clock, answer_time=5.0).ask("mug", [candidate(frame, box_of(frame, "mug_1"))])
    assert not job.done()
    clock.time = 5.0
    assert job.done()
    assert job.result().accepted == 0


def test_waiting_for_an_answer_advances_the_clock(frame):
    clock = HandClock()
    assert Oracle(["mug_1"], clock, answer_time=5.0).ask("mug", []).result().accepted is None
    assert clock.time == 5.0


def test_an_answer_that_takes_time_needs_a_clock():
    with pytest.raises(ValueError, match="needs a clock"):
        Oracle(["mug_1"], answer_time=1.0)


def test_the_reason_names_what_was_seen(frame):
    assert "mug_1" in ask(Oracle("mug"), candidate(frame, box_of(frame, "mug_1"))).reason
    assert "none of 1" in ask(Oracle("mug"), candidate(frame, Box(0, 0, 9, 9))).reason
