"""zavis_bt: behaviour-tree robot applications that find things."""

__version__ = "0.1.0"
