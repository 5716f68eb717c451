import zavis_bt.planning


def test_every_public_name_exists():
    assert all(hasattr(zavis_bt.planning, name) for name in zavis_bt.planning.__all__)
