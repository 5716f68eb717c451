"""Faults of a tree file: each with its place, all reported at once."""

from __future__ import annotations

from dataclasses import dataclass, field

from zavis_bt.errors import TreeError


@dataclass(frozen=True, slots=True, order=True)
class Mark:
    """A place in a file; line and column count from one."""

    file: str
    line: int
    column: int

    def __str__(self) -> str:
        return f"{self.file}:{self.line}:{self.column}"


@dataclass(frozen=True, slots=True, order=True)
class Fault:
    """Something wrong at a place."""

    mark: Mark
    code: str
    message: str

    def __str__(self) -> str:
        return f"{self.mark}: error[{self.code}]: {self.message}"


@dataclass(slots=True)
class Faults:
    """Collects what every stage finds."""

    found: list[Fault] = field(default_factory=list)

    def add(self, mark: Mark, code: str, message: str) -> None:
        """Note a fault."""
        self.found.append(Fault(mark, code, message))

    def __bool__(self) -> bool:
        return bool(self.found)

    def raise_if_any(self) -> None:
        """Report all faults, sorted by their places.

        Raises:
            TreeError: There is at least one.
        """
        unread = {fault.mark for fault in self.found if fault.code == "syntax"}
        found = [fault for fault in self.found if fault.code == "syntax" or fault.mark not in unread]
        if found:
            raise TreeError("\n".join(map(str, dict.fromkeys(sorted(found)))))
