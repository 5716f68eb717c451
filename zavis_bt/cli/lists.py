"""Arguments that are lists: values with commas between."""

from __future__ import annotations

from zavis_bt.errors import InputError


def listed(text: str) -> tuple[str, ...]:
    """Return the values, without the blanks around them and without empty ones."""
    return tuple(value for part in text.split(",") if (value := part.strip()))


def whole_numbers(text: str, option: str, example: str) -> tuple[int, ...]:
    """Return the values as whole numbers.

    Args:
        text: Values with commas between.
        option: Whose argument it is, as it is typed.
        example: A good one.

    Raises:
        InputError: One is no whole number.
    """
    try:
        return tuple(int(part) for part in text.split(","))
    except ValueError:
        raise InputError(f"{option}: '{text}' are no whole numbers (e.g. {example})") from None
