"""Settings of simulated perception that err as the small networks that come along do.

Measured by `python -m benchmarks.fit_simulated_perception` on rendered frames of homes; docs/simulated_perception.md
says how.
"""

from __future__ import annotations

from types import MappingProxyType

from sim.perception.curves import DetectorSettings, MatcherSettings

FITTED_TO_NETWORKS = (
    DetectorSettings(
        ceiling=0.96,
        half_size=6.1,
        slope=0.58,
        short_side=(0.5, 4.5),
        visible=(0.05, 0.28),
        visible_furniture=(0.02, 0.022),
        false_positives=3.5,
        most_false=8,
        parts=0.32,
        jitter=0.1,
        known_as_unknown=0.91,
        unknown_as_known=0.04,
    ),
    MatcherSettings(
        match=29.9,
        background=19.3,
        background_spread=3.9,
        instance_spread=2.2,
        view_spread=3.3,
        small_loss=0.9,
    ),
)
"""Of detector and matcher."""
FITTED_THRESHOLDS = MappingProxyType({"match": 29.0, "landmark": 33.7, "temperature": 0.96})
"""That belong to them: as many texts pass as pass those of the networks."""
