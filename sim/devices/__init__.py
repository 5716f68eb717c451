"""The simulated robot as hardware: devices that speak the real wire protocols."""
