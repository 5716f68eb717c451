"""The robot's micro-controller while one client is connected: motors, sensors, switches."""

from __future__ import annotations

from drivers.pioneer.codec import Flags
from sim.devices.arcos.aux import AuxPort
from sim.devices.arcos.bumpers import Bumpers
from sim.devices.arcos.drive import WheelDrive
from sim.devices.arcos.model import PioneerModel
from sim.devices.arcos.odometer import Odometer
from sim.devices.arcos.profile import Ramp
from sim.devices.arcos.sonar import Sonar
from sim.devices.plant import Plant
from sim.physics import STEPS_PER_SECOND

_AUX_PORTS = 3


class Controller:
    """All state that the stored defaults replace when a connection ends; motors are off at first."""

    def __init__(self, plant: Plant, model: PioneerModel, odometer: Odometer) -> None:
        """Begin with the stored configuration; the odometry begins here."""
        self.plant, self.model, self.odometer = plant, model, odometer
        self.drive = WheelDrive(model.config, 1 / STEPS_PER_SECOND)
        self.sonar, self.bumpers = Sonar(plant, model), Bumpers(plant, model)
        self.aux = tuple(AuxPort(number + 1) for number in range(_AUX_PORTS))
        self.motors = False
        """Whether the motors have power."""
        self.stops_on_bump = 0
        """Bit 0: the front bumper stops the robot; bit 1: the rear bumper."""
        self.button_stalls = True
        """Whether the STOP button is reported as a stall too."""
        self.e_stall = False
        """Whether the STOP button has stalled the robot since the motors were switched on."""
        self.battery_test = 0
        """Voltage to pretend [0.1 V]; 0 for the real one."""
        self.analog_port = self.digital_out = 0
        self.encoder_packets = self.io_packets = 0
        """How many are still to be sent: 0, 1, or 2 for a stream."""
        self._commanded = 0.0
        odometer.zero(plant.motion)

    @property
    def voltage(self) -> float:
        """Of the battery [V]."""
        if self.battery_test:
            return self.battery_test / 10
        empty, full = self.model.battery_empty, self.model.battery_full
        return empty + (full - empty) * min(max(self.plant.charge, 0.0), 1.0)

    @property
    def charge(self) -> float:
        """State of charge that follows from the voltage, 0 to 1."""
        empty, full = self.model.battery_empty, self.model.battery_full
        return min(max((self.voltage - empty) / (full - empty), 0.0), 1.0)

    @property
    def flags(self) -> int:
        """Flags of the information packet."""
        return (
            self.sonar.flags
            | (Flags.MOTORS_ENABLED if self.motors else 0)
            | (Flags.STOP_PRESSED if self.plant.estop else 0)
            | (Flags.E_STALL if self.e_stall else 0)
        )

    def enable(self, on: bool) -> None:
        """Switch the motors; while the STOP button is pressed they stay off."""
        self.motors = on and not self.plant.estop
        self.drive.stop()
        if self.motors:
            self.e_stall = False

    def step(self, now: float) -> None:
        """Work for the next step of the world, at a time [s]."""
        motion = self.plant.motion
        if self.plant.estop:
            self.e_stall = self.e_stall or self.button_stalls
            self.enable(False)
        bumped = self.bumpers.step(now, motion, self._commanded)
        pressed = (1 if self.bumpers.front else 0) | (2 if self.bumpers.rear else 0)
        if bumped and pressed & self.stops_on_bump:
            self.drive.stop()
        self.sonar.step(now)
        translation, rotation = self.drive.step(motion, self.odometer)
        if not self.motors:
            # The motors' brakes hold a robot whose motors are off.
            translation = Ramp(0.0, self.drive.translation.top_acceleration)
            rotation = Ramp(0.0, self.drive.rotation.top_acceleration)
        self._commanded = translation.speed
        self.plant.drive(translation.speed, rotation.speed, translation.change, rotation.change)
