"""Driver of planar LiDARs over SCIP 2.0."""
