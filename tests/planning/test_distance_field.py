import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays
from scipy.ndimage import distance_transform_edt

from zavis_bt.planning.distance_field import distance_field

GRIDS = arrays(np.bool_, array_shapes(min_dims=2, max_dims=2, min_side=1, max_side=14), elements=st.booleans())


@settings(max_examples=150, deadline=None)
@given(GRIDS, st.booleans())
def test_distances_are_exact_and_nearest_obstacles_are_that_far(obstacle, closed):
    field = distance_field(obstacle, closed)
    if not obstacle.any() and not closed:
        assert np.isinf(field.distance).all()
        return
    padded = np.pad(obstacle, 1, constant_values=closed)
    np.testing.assert_allclose(field.distance, distance_transform_edt(~padded)[1:-1, 1:-1], rtol=1e-6)
    rows, cols = np.indices(obstacle.shape)
    found = field.nearest.astype(int)
    np.testing.assert_allclose(np.hypot(found[..., 0] - rows, found[..., 1] - cols), field.distance, rtol=1e-6)
    assert padded[found[..., 0] + 1, found[..., 1] + 1].all()


def test_results_are_read_only():
    field = distance_field(np.eye(4, dtype=np.bool_))
    with pytest.raises(ValueError, match="read-only"):
        field.distance[0, 0] = 1.0
