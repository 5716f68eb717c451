"""The commonsense table: where household objects usually are."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from importlib import resources
from pathlib import Path

from zavis_bt.errors import InputError, did_you_mean
from zavis_bt.knowledge.text import normalise, phrases, singular

_BUILT_IN = "commonsense.txt"


@dataclass(frozen=True)
class CommonsenseTable:
    """Usual places of objects, and other names of both. All names are normalised."""

    objects: Mapping[str, tuple[str, ...]]
    """Places of each object, the most usual first."""
    aliases: Mapping[str, str]
    """Other name → name."""

    @cached_property
    def places(self) -> tuple[str, ...]:
        """Every place once, sorted."""
        return tuple(sorted({place for places in self.objects.values() for place in places}))

    @cached_property
    def _index(self) -> dict[str, str]:
        """Whatever a thing may be called → its name; exact names win over singulars (glasses are not glass)."""
        exact = {name: name for name in (*self.places, *self.objects)} | dict(self.aliases)
        return {singular(name): target for name, target in exact.items()} | exact

    def find(self, text: str) -> str | None:
        """Return the name of the object or place the text speaks of, or None if the table has neither.

        Numbers, articles, colours and other adjectives may precede the name, a description may follow it.
        """
        for phrase in phrases(normalise(text)):
            found = self._index.get(phrase) or self._index.get(singular(phrase))
            if found:
                return found
        return None


def load_table(path: Path | str | None = None) -> CommonsenseTable:
    """Read a commonsense table.

    Each line is one of ``object: place, place, …`` (the most usual place first), ``name = other name, …``, a comment
    that starts with ``#``, or blank.

    Args:
        path: UTF-8 text file; None for the built-in table.

    Returns:
        The table.

    Raises:
        InputError: The file cannot be read, or a line is wrong: ``file:line: what``.
    """
    if path is None:
        return parse_table((resources.files(__package__) / _BUILT_IN).read_text(encoding="utf-8"), _BUILT_IN)
    try:
        text = Path(path).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "not UTF-8 text"
        raise InputError(f"{path}: cannot be read as a commonsense table: {reason}") from error
    return parse_table(text, str(path))


def parse_table(text: str, source: str) -> CommonsenseTable:
    """Parse a commonsense table; see `load_table`. ``source`` names the text in errors."""
    objects: dict[str, tuple[str, ...]] = {}
    aliases: dict[str, str] = {}
    alias_lines: dict[str, str] = {}
    for where, name, sign, names in _lines(text, source):
        if sign == ":":
            if name in objects:
                raise InputError(f"{where}: object '{name}' is listed twice (merge the two lines)")
            objects[name] = names
            continue
        for other in names:
            if other in aliases:
                raise InputError(f"{where}: '{other}' already is another name of '{aliases[other]}' (keep one)")
            aliases[other], alias_lines[other] = name, where
    if not objects:
        raise InputError(f"{source}: no object (needs at least one line 'object: place, place')")
    table = CommonsenseTable(objects, aliases)
    _check_aliases(table, alias_lines)
    return table


def _lines(text: str, source: str) -> Iterator[tuple[str, str, str, tuple[str, ...]]]:
    """Yield (file:line, name before the sign, ``:`` or ``=``, names after it) of every line with content."""
    for number, line in enumerate(text.splitlines(), start=1):
        where, content = f"{source}:{number}", line.strip()
        if not content or content.startswith("#"):
            continue
        sign = next((char for char in content if char in ":="), None)
        if sign is None:
            raise InputError(f"{where}: '{content}' is no entry (write 'object: place, …' or 'name = other name, …')")
        left, _, right = content.partition(sign)
        name, names = normalise(left), tuple(normalise(part) for part in right.split(","))
        if not name or not all(names):
            raise InputError(f"{where}: empty name (write 'object: place, …' or 'name = other name, …')")
        if repeated := next((other for other in names if names.count(other) > 1), None):
            raise InputError(f"{where}: '{repeated}' is listed twice (once is enough)")
        yield where, name, sign, names


def _check_aliases(table: CommonsenseTable, lines: Mapping[str, str]) -> None:
    known = {*table.places, *table.objects}
    for other, name in table.aliases.items():
        if other in known:
            raise InputError(f"{lines[other]}: '{other}' is a name of its own, not one of '{name}' too (keep one)")
        if name not in known:
            raise InputError(f"{lines[other]}: no object or place is called '{name}'{did_you_mean(name, known)}")
