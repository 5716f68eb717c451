"""Settings of simulated perception that err as the small networks that come along do.

Measured by `python -m benchmarks.fit_simulated_perception` on rendered frames; docs/simulated_perception.md compares.
"""

from __future__ import annotations

from sim.perception.curves import DetectorSettings, MatcherSettings

FITTED_TO_NETWORKS = (DetectorSettings(), MatcherSettings())
