"""The simulated Pioneer: ARCOS on TCP and on a pseudo-terminal."""

from sim.devices.arcos.firmware import Firmware, Line, Reply
from sim.devices.arcos.handshake import Phase
from sim.devices.arcos.model import P3AT, P3DX, PioneerModel
from sim.devices.arcos.pty import ArcosPty
from sim.devices.arcos.tcp import ArcosServer

__all__ = ["P3AT", "P3DX", "ArcosPty", "ArcosServer", "Firmware", "Line", "Phase", "PioneerModel", "Reply"]
