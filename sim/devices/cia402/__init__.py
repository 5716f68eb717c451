"""A pan-tilt unit of two CiA 402 drives on a CAN bus."""

from sim.devices.cia402.dictionary import export_eds, object_dictionary
from sim.devices.cia402.drives import Cia402Drives

__all__ = ["Cia402Drives", "export_eds", "object_dictionary"]
