"""Settings of simulated perception that err as the small networks that come along do.

Measured by `python -m benchmarks.fit_simulated_perception` on rendered frames of homes; docs/simulated_perception.md
says how.
"""

from __future__ import annotations

from types import MappingProxyType

from sim.perception.curves import DetectorSettings, MatcherSettings

FITTED_TO_NETWORKS = (
    DetectorSettings(
        ceiling=0.98,
        half_size=23.3,
        slope=1.02,
        short_side=(0.5, 6.7),
        visible=(0.05, 0.55),
        visible_furniture=(0.02, 0.03),
        false_positives=8.5,
        most_false=16,
        parts=0.27,
        jitter=0.1,
        known_as_unknown=0.97,
        unknown_as_known=0.04,
    ),
    MatcherSettings(
        match=26.6,
        background=18.1,
        background_spread=3.6,
        instance_spread=3.3,
        view_spread=2.5,
        small_loss=0.9,
    ),
)
"""Of detector and matcher."""
FITTED_THRESHOLDS = MappingProxyType({"match": 29.0, "landmark": 28.7, "temperature": 1.26})
"""That belong to them: as many texts pass as pass those of the networks."""
