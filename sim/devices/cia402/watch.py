"""A drive's watch over the heartbeats of other nodes."""

from __future__ import annotations

_ENTRIES = 4


class HeartbeatWatch:
    """Knows when a watched node has fallen silent. The watch over a node begins with its first heartbeat."""

    def __init__(self) -> None:
        self._times: dict[int, tuple[int, float]] = {}
        self._heard: dict[int, float] = {}

    def watch(self, entry: int, word: int) -> None:
        """Set one of the watches: node << 16 | milliseconds; 0 for none."""
        node, milliseconds = word >> 16 & 0x7F, word & 0xFFFF
        before = self._times.pop(entry, None)
        if before is not None:
            self._heard.pop(before[0], None)
        if node and milliseconds and 1 <= entry <= _ENTRIES:
            self._times[entry] = node, milliseconds * 1e-3

    def hear(self, node: int, now: float) -> None:
        """Note a heartbeat."""
        if any(watched == node for watched, _ in self._times.values()):
            self._heard[node] = now

    def lost(self, now: float) -> bool:
        """Return whether a node has fallen silent since the last call; it is watched again once it is heard."""
        silent = [
            node for node, limit in self._times.values() if node in self._heard and now - self._heard[node] > limit
        ]
        for node in silent:
            del self._heard[node]
        return bool(silent)

    def clear(self) -> None:
        """Watch nobody."""
        self._times.clear()
        self._heard.clear()
