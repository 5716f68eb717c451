"""Pan-tilt units of two CiA 402 drives on CANopen."""
