"""Success weighted by path length."""

from __future__ import annotations


def spl(success: bool, path_length: float, shortest: float) -> float:
    """Return success weighted by path length, S·l / max(p, l) (Anderson et al. 2018).

    Args:
        success: S.
        path_length: p, what was driven [m].
        shortest: l, the shortest geodesic path to a pose at which success is possible [m].

    Returns:
        0 to 1; a success with l = 0 counts 1.
    """
    if not success:
        return 0.0
    return shortest / max(path_length, shortest) if shortest > 0 else 1.0
