"""A line that somebody types while other lines above it change."""

from __future__ import annotations

_DELETE, _CLEAR = ("\x7f", "\b"), ("\x15", "escape")
_END = ("\r", "\n")


class LineEditor:
    """Collects keys to lines, with Backspace, Ctrl-U, and the arrows up and down for earlier lines."""

    def __init__(self) -> None:
        self.text = ""
        """What has been typed so far."""
        self._earlier: list[str] = []
        self._back = 0

    def press(self, key: str) -> str | None:
        """Take a key; return the line when it is complete."""
        if key in _END:
            line, self.text, self._back = self.text, "", 0
            if line.strip() and self._earlier[-1:] != [line]:
                self._earlier.append(line)
            return line
        if key in _DELETE:
            self.text = self.text[:-1]
        elif key in _CLEAR:
            self.text = ""
        elif key in ("up", "down"):
            self._recall(1 if key == "up" else -1)
        elif len(key) == 1 and key.isprintable():
            self.text += key
        return None

    def _recall(self, step: int) -> None:
        self._back = min(max(self._back + step, 0), len(self._earlier))
        self.text = self._earlier[-self._back] if self._back else ""
