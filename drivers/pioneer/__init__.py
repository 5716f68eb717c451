"""Driver of Pioneer robots over ARCOS."""
