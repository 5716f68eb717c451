"""What planning can fail with."""

from __future__ import annotations

from zavis_bt.errors import ZavisError


class PlanningError(ZavisError):
    """There is no path; the message says why: ``goal is in an obstacle``, ``no path``, …."""
