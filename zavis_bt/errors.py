"""Errors that a caller handles differently.

    ZavisError                 anything a user can cause and mend; shown as one line
    ├── InputError             a file or argument is wrong: where, what, what would be right
    │   └── TreeError          a tree has one or more faults; one line each
    ├── DeviceError            a device cannot be opened or failed in operation
    └── MissionAborted         the mission was stopped from outside

A line reads ``where: what is wrong (what would be right)``.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable


class ZavisError(Exception):
    """Base of every error that is the user's or the hardware's, not a bug."""


class InputError(ZavisError):
    """A file or an argument is wrong."""


class TreeError(InputError):
    """A behaviour tree has faults; the message holds one line for each."""


class DeviceError(ZavisError):
    """A device cannot be opened, or failed while it was used."""


class MissionAborted(ZavisError):
    """The mission was stopped from outside before it could end by itself."""


def did_you_mean(name: str, choices: Iterable[str]) -> str:
    """Return `` (did you mean 'x'?)`` for the closest choice, or the list of choices, or nothing.

    Args:
        name: What was written.
        choices: What could have been meant.

    Returns:
        Text to append to an error message; empty if there are no choices.
    """
    known = sorted(set(choices))
    close = difflib.get_close_matches(name, known, n=1, cutoff=0.6)
    if close:
        return f" (did you mean '{close[0]}'?)"
    return f" (one of: {', '.join(known)})" if 0 < len(known) <= 30 else ""
