"""Why the unit cannot do what it should."""


class Trouble(Exception):
    """One line in plain words with the remedy, without the place in the robot file; callers see a `DeviceError`."""
