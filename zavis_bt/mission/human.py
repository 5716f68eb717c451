"""People who answer: at the terminal, or a policy where nobody is there."""

from __future__ import annotations

import sys
import threading
from collections.abc import Callable, Sequence
from pathlib import Path

from zavis_bt.mission.jobs import DoneJob
from zavis_bt.protocols import Clock, Human, Job
from zavis_bt.types import Answer, Candidate


class _Reply:
    """An answer that another thread will give."""

    def __init__(self) -> None:
        self._event, self._answer = threading.Event(), Answer(None, "no answer")

    def give(self, answer: Answer) -> None:
        self._answer = answer
        self._event.set()

    def done(self) -> bool:
        return self._event.is_set()

    def result(self) -> Answer:
        self._event.wait()
        return self._answer

    def cancel(self) -> None:
        self.give(Answer(None, "question withdrawn"))


class TerminalHuman:
    """Asks at the terminal; candidate pictures are saved where the person can open them."""

    def __init__(self, pictures: Path, *, ask: Callable[[str], str] = input) -> None:
        """Describe the dialogue.

        Args:
            pictures: Folder for the candidates' pictures; made when first needed.
            ask: Prints a prompt and returns a line; raises EOFError when nobody can answer.
        """
        self._pictures, self._ask = pictures, ask
        self._asked = 0

    def ask(self, target: str, candidates: Sequence[Candidate]) -> Job[Answer]:
        """Show the candidates and wait for a number on a thread of its own."""
        self._asked += 1
        reply = _Reply()
        shown = self._save(candidates)
        threading.Thread(target=self._dialogue, args=(target, shown, reply), daemon=True, name="terminal").start()
        return reply

    def _save(self, candidates: Sequence[Candidate]) -> list[tuple[Candidate, Path]]:
        from zavis_bt.recording.candidate_images import candidate_image, encode_png

        self._pictures.mkdir(parents=True, exist_ok=True)
        shown = []
        for number, candidate in enumerate(candidates, start=1):
            path = self._pictures / f"question_{self._asked:02d}_{number}.png"
            path.write_bytes(encode_png(candidate_image(candidate)))
            shown.append((candidate, path))
        return shown

    def _dialogue(self, target: str, shown: list[tuple[Candidate, Path]], reply: _Reply) -> None:
        lines = [f"\nIs one of these “{target}”?"]
        for number, (candidate, path) in enumerate(shown, start=1):
            x, y, z = candidate.position
            lines.append(f"  {number}: {path}  score {candidate.score:.1f}, at ({x:.1f}, {y:.1f}), {z:.1f} m high")
        lines.append(f"Number 1–{len(shown)}, or n for none: ")
        prompt = "\n".join(lines)
        while not reply.done():
            try:
                text = self._ask(prompt).strip().lower()
            except (EOFError, OSError):
                reply.give(Answer(None, "nobody at the terminal"))
                return
            if text in ("n", "no", "0", "none"):
                reply.give(Answer(None, "turned down"))
            elif text in ("y", "yes") and len(shown) == 1:
                reply.give(Answer(0, "confirmed"))
            elif text.isdigit() and 1 <= int(text) <= len(shown):
                reply.give(Answer(int(text) - 1, "confirmed"))
            else:
                print(f"'{text}' is no answer (a number from 1 to {len(shown)}, or n).", file=sys.stderr)


class _TimedReply:
    """An answer with a deadline and a policy for when it passes."""

    def __init__(self, job: Job[Answer], clock: Clock, deadline: float, otherwise: Answer) -> None:
        self._job, self._clock, self._deadline, self._otherwise = job, clock, deadline, otherwise

    def done(self) -> bool:
        return self._job.done() or self._clock.now() >= self._deadline

    def result(self) -> Answer:
        if self._job.done() or self._clock.now() < self._deadline:
            return self._job.result()
        self._job.cancel()
        return self._otherwise

    def cancel(self) -> None:
        self._job.cancel()


class WithTimeout:
    """A person with a deadline: when it passes, the policy answers."""

    def __init__(self, human: Human, clock: Clock, seconds: float, *, accept: bool) -> None:
        """Set the policy.

        Args:
            human: Who is asked.
            clock: The mission's clock.
            seconds: Time to answer [s].
            accept: Whether silence means that the best candidate is the target.
        """
        self._human, self._clock, self._seconds = human, clock, seconds
        self._otherwise = Answer(0 if accept else None, f"no answer within {seconds:g} s")

    def ask(self, target: str, candidates: Sequence[Candidate]) -> Job[Answer]:
        """Ask; the job is done when the person answered or the time is over."""
        job = self._human.ask(target, candidates)
        return _TimedReply(job, self._clock, self._clock.now() + self._seconds, self._otherwise)


class TimeStandsStill:
    """A person for whom a lock-step simulation waits: no simulated time passes while they think."""

    def __init__(self, human: Human) -> None:
        self._human = human

    def ask(self, target: str, candidates: Sequence[Candidate]) -> Job[Answer]:
        """Ask and wait for the answer."""
        return DoneJob(self._human.ask(target, candidates).result())


class Nobody:
    """A person who never answers: only a timeout policy ends the question."""

    def ask(self, target: str, candidates: Sequence[Candidate]) -> Job[Answer]:
        """Ask nobody."""
        return _Reply()
