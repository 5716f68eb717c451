"""Missions and baselines as YAML trees, with their parts."""
