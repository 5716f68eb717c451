"""Driver of Pioneer robots over ARCOS, on a serial port or TCP."""

from drivers.pioneer.base import PioneerBase, open_base
from drivers.pioneer.models import Parameters, parameters_of
from drivers.pioneer.settings import PioneerSettings
from drivers.pioneer.sonar import Echo

__all__ = ["Echo", "Parameters", "PioneerBase", "PioneerSettings", "open_base", "parameters_of"]
