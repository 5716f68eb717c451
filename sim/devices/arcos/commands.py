"""What each command does. Those that are not in the table are ignored, as the robot does."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from types import MappingProxyType

from drivers.pioneer.codec import Command, CommandNumber
from sim.devices.arcos.controller import Controller

Handler = Callable[[Controller, Command], None]
_Set = Callable[[Controller, int], None]


def obey(controller: Controller, command: Command) -> bool:
    """Carry out a command; return whether it was one that moves the robot and was accepted.

    Motion commands have no effect while the motors are off, and are dropped while an emergency stop is in progress.
    """
    if move := _MOTION.get(command.number):
        if not controller.motors or controller.drive.braking or command.argument is None:
            return False
        move(controller, command)
        return True
    if handler := _OTHER.get(command.number):
        handler(controller, command)
    return False


def _with_integer(handle: _Set) -> Handler:
    """Return a handler that takes the integer argument, and does nothing without.

    It is a 16-bit number, so that clients that send two's complement instead of sign and magnitude are understood.
    """

    def handler(controller: Controller, command: Command) -> None:
        if isinstance(command.argument, int):
            handle(controller, (command.argument + 0x8000) % 0x10000 - 0x8000)

    return handler


def _turn_by(controller: Controller, degrees: int) -> None:
    controller.drive.turn_to(controller.odometer.yaw + math.radians(degrees))


def _turn_on(controller: Controller, degrees: int) -> None:
    controller.drive.turn_to(controller.drive.setpoint + math.radians(degrees))


def _turn_to(controller: Controller, degrees: int) -> None:
    controller.drive.turn_to(controller.odometer.yaw_of(math.radians(degrees)))


def _spin(controller: Controller, degrees: int) -> None:
    controller.drive.set_spin(math.radians(degrees))


def _wheels(controller: Controller, command: Command) -> None:
    model = controller.model
    left, right = (half * model.vel2_unit for half in command.halves())
    controller.drive.set_wheels((left + right) / 2000, (right - left) / 2 * model.diff_conv_factor)


def _digital_out(controller: Controller, value: int) -> None:
    mask, states = value >> 8 & 0xFF, value & 0xFF
    controller.digital_out = controller.digital_out & ~mask | states & mask


def _enable(controller: Controller, value: int) -> None:
    if bool(value) != controller.motors:
        controller.enable(bool(value))


def _write_aux(port: int) -> Handler:
    return lambda controller, command: controller.aux[port].write(command.string())


def _ask_aux(port: int) -> Handler:
    return _with_integer(lambda controller, count: controller.aux[port].ask(min(abs(count), 200)))


def _set_aux_baud(port: int) -> Handler:
    return _with_integer(lambda controller, code: setattr(controller.aux[port], "baud", code & 0xFF))


def _set(name: str, mask: int) -> Handler:
    return _with_integer(lambda controller, value: setattr(controller, name, abs(value) & mask))


def _stream(name: str) -> Handler:
    return _with_integer(lambda controller, count: setattr(controller, name, min(max(count, 0), 2)))


_MOTION: Mapping[int, Handler] = MappingProxyType(
    {
        CommandNumber.MOVE: _with_integer(lambda controller, value: controller.drive.cover(value / 1000)),
        CommandNumber.VEL: _with_integer(lambda controller, value: controller.drive.set_speed(value / 1000)),
        CommandNumber.ROTATE: _with_integer(_spin),
        CommandNumber.RVEL: _with_integer(_spin),
        CommandNumber.HEAD: _with_integer(_turn_to),
        CommandNumber.DHEAD: _with_integer(_turn_by),
        CommandNumber.DCHEAD: _with_integer(_turn_on),
        CommandNumber.VEL2: _wheels,
    }
)

_OTHER: Mapping[int, Handler] = MappingProxyType(
    {
        CommandNumber.ENABLE: _with_integer(_enable),
        CommandNumber.SETV: _with_integer(lambda controller, value: controller.drive.translation.set_speed(value)),
        CommandNumber.SETA: _with_integer(
            lambda controller, value: controller.drive.translation.set_acceleration(value)
        ),
        CommandNumber.SETRV: _with_integer(lambda controller, value: controller.drive.rotation.set_speed(value)),
        CommandNumber.SETRA: _with_integer(lambda controller, value: controller.drive.rotation.set_acceleration(value)),
        CommandNumber.SETO: lambda controller, command: controller.odometer.zero(controller.plant.motion),
        CommandNumber.STOP: lambda controller, command: controller.drive.stop(),
        CommandNumber.E_STOP: lambda controller, command: controller.drive.brake(),
        CommandNumber.E_STOP_ALTERNATIVE: lambda controller, command: controller.drive.brake(),
        CommandNumber.E_STALL: _with_integer(lambda controller, on: setattr(controller, "button_stalls", bool(on))),
        CommandNumber.BUMPSTALL: _set("stops_on_bump", 3),
        CommandNumber.SONAR: _with_integer(lambda controller, value: controller.sonar.switch(value)),
        CommandNumber.SONARCYCLE: _with_integer(lambda controller, value: controller.sonar.set_cycle(value)),
        CommandNumber.POLLING: lambda controller, command: controller.sonar.poll(command.string()),
        CommandNumber.ENCODER: _stream("encoder_packets"),
        CommandNumber.IOREQUEST: _stream("io_packets"),
        CommandNumber.DIGOUT: _with_integer(_digital_out),
        CommandNumber.ADSEL: _set("analog_port", 0xFF),
        CommandNumber.BATTEST: _set("battery_test", 0xFF),
        CommandNumber.TTY2: _write_aux(0),
        CommandNumber.TTY3: _write_aux(1),
        CommandNumber.TTY4: _write_aux(2),
        CommandNumber.GETAUX: _ask_aux(0),
        CommandNumber.GETAUX2: _ask_aux(1),
        CommandNumber.GETAUX3: _ask_aux(2),
        CommandNumber.AUX1BAUD: _set_aux_baud(0),
        CommandNumber.AUX2BAUD: _set_aux_baud(1),
        CommandNumber.AUX3BAUD: _set_aux_baud(2),
    }
)
