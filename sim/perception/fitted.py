"""Settings of simulated perception that err as the small networks that come along do.

Measured by `python -m benchmarks.fit_simulated_perception` on rendered frames of homes; docs/simulated_perception.md
says how.
"""

from __future__ import annotations

from types import MappingProxyType

from sim.perception.curves import DetectorSettings, MatcherSettings

FITTED_TO_NETWORKS = (
    DetectorSettings(
        ceiling=0.95,
        half_size=3.1,
        slope=0.46,
        short_side=(0.5, 6.5),
        visible=(0.05, 0.48),
        visible_furniture=(0.02, 0.03),
        false_positives=3.7,
        most_false=8,
        parts=0.34,
        jitter=0.1,
        known_as_unknown=0.89,
        unknown_as_known=0.04,
    ),
    MatcherSettings(
        match=29.7,
        background=19.5,
        background_spread=3.7,
        instance_spread=1.6,
        view_spread=3.4,
        small_loss=0.69,
    ),
)
"""Of detector and matcher."""
FITTED_THRESHOLDS = MappingProxyType({"match": 29.0, "landmark": 33.2, "temperature": 1.05})
"""That belong to them: as many texts pass as pass those of the networks."""
