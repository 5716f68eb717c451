from __future__ import annotations

import numpy as np

from zavis_bt.mission import Dialogue, DoneJob, MissionJournal, Nobody, TerminalHuman, WithTimeout
from zavis_bt.types import Answer, Box, CameraIntrinsics, Candidate, RgbdFrame


class HandClock:
    def __init__(self) -> None:
        self.time = 0.0

    def now(self) -> float:
        return self.time

    def wait_until(self, stamp: float) -> None:
        self.time = max(self.time, stamp)


class ScriptedHuman:
    def __init__(self, *answers: int | None) -> None:
        self.answers, self.shown = list(answers), []

    def ask(self, target, candidates):
        self.shown.append(list(candidates))
        return DoneJob(Answer(self.answers.pop(0)))


def candidate(x: float, score: float = 30.0, side: float = 4.0) -> Candidate:
    pixels = np.full((8, 8, 3), 200, np.uint8), np.ones((8, 8), np.float32)
    frame = RgbdFrame(CameraIntrinsics.from_fov(8, 8, 1.0), np.eye(4), 0.0, lambda: pixels)
    return Candidate("cup", score, Box(1, 1, 1 + side, 1 + side), (x, 0.0, 0.8), frame)


def dialogue(human) -> Dialogue:
    return Dialogue(human, MissionJournal(HandClock()))


def test_a_thing_turned_down_twice_is_not_shown_again():
    human = ScriptedHuman(None, None)
    talk = dialogue(human)
    for _ in range(3):
        answer = talk.ask("cup", [candidate(1.0)]).result()
    assert len(human.shown) == 2
    assert answer.accepted is None
    assert "before" in answer.reason


def test_a_much_closer_view_is_shown_again_and_the_poor_ones_never():
    human = ScriptedHuman(None, None, None, None)
    talk = dialogue(human)
    sides = (2.0, 2.0, 2.9, 3.1, 3.1, 3.1, 2.0)
    shown = []
    for side in sides:
        talk.ask("cup", [candidate(1.0, side=side)]).result()
        shown.append(len(human.shown))
    assert shown == [1, 2, 2, 3, 4, 4, 4]  # 1.5 times as large, not 1.45 times


def test_larger_is_meant_as_an_angle():
    pixels = np.full((4, 4, 3), 200, np.uint8), np.ones((4, 4), np.float32)
    coarse = RgbdFrame(CameraIntrinsics.from_fov(4, 4, 1.0), np.eye(4), 0.0, lambda: pixels)
    human = ScriptedHuman(None, None)
    talk = dialogue(human)
    for seen in (Candidate("cup", 30.0, Box(0, 0, 2, 2), (0.0, 0.0, 0.8), coarse), candidate(0.0), candidate(0.0)):
        talk.ask("cup", [seen]).result()
    assert len(human.shown) == 2  # half the pixels of a camera of half the width is as large


def test_an_accepted_index_refers_to_the_list_that_was_given():
    human = ScriptedHuman(None, None, 0)
    talk = dialogue(human)
    talk.ask("cup", [candidate(1.0)]).result()
    talk.ask("cup", [candidate(1.0)]).result()
    assert talk.ask("cup", [candidate(1.0), candidate(3.0)]).result().accepted == 1


def test_many_views_of_one_thing_leave_room_for_others():
    talk = dialogue(ScriptedHuman())
    views = [candidate(1.0 + 0.001 * i) for i in range(10)] + [candidate(4.0)]
    assert talk.news(views) == [0, 1, 10]


def test_each_question_is_journalled_once():
    journal = MissionJournal(HandClock())
    talk = Dialogue(ScriptedHuman(None, None), journal)
    for _ in range(4):
        talk.ask("cup", [candidate(0.0)]).result()
    assert journal.counts["ask"] == 2


def test_terminal_answers_by_number_and_saves_the_pictures(tmp_path):
    lines = iter(["what?", "2"])
    prompts = []

    def ask(prompt: str) -> str:
        prompts.append(prompt)
        return next(lines)

    job = TerminalHuman(tmp_path / "questions", ask=ask).ask("cup", [candidate(0.0), candidate(1.0)])
    assert job.result().accepted == 1
    assert "cup" in prompts[0]
    assert sorted(p.name for p in (tmp_path / "questions").iterdir()) == ["question_01_1.png", "question_01_2.png"]


def test_nobody_at_the_terminal_counts_as_no(tmp_path):
    def ask(prompt: str) -> str:
        raise EOFError

    answer = TerminalHuman(tmp_path, ask=ask).ask("cup", [candidate(0.0)]).result()
    assert answer.accepted is None
    assert "nobody" in answer.reason


def test_a_deadline_ends_the_question_with_the_policys_answer():
    clock = HandClock()
    for accept, expected in ((False, None), (True, 0)):
        job = WithTimeout(Nobody(), clock, 30.0, accept=accept).ask("cup", [candidate(0.0)])
        assert not job.done()
        clock.wait_until(clock.now() + 30.0)
        assert job.done()
        assert job.result().accepted is expected
