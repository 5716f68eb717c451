"""The packets in which the robot tells of itself."""

from __future__ import annotations

import math
from dataclasses import replace
from struct import Struct

from drivers.pioneer.codec import (
    ANGLE_STEPS,
    Config,
    Encoders,
    PacketType,
    Sip,
    encode,
    encode_encoders,
)
from sim.devices.arcos.controller import Controller

_IO = Struct("<B4BBBB9H")
_STANDING = 1e-4  # wheels slower than this stand [m/s, rad/s]


def information(controller: Controller) -> Sip:
    """Return the standard information packet."""
    motion, odometer = controller.plant.motion, controller.odometer
    pose, bumpers, spin = odometer.pose_of(motion), controller.bumpers, motion.angular
    factor = controller.model.distance_factor
    speed, half_difference = motion.linear * 1000, spin / controller.model.diff_conv_factor
    battery = round(controller.voltage * 10)
    return Sip(
        moving=max(abs(motion.linear), abs(spin)) > _STANDING,
        x=round(pose.x * 1000 / factor) & 0xFFFF,
        y=round(pose.y * 1000 / factor) & 0xFFFF,
        heading=_steps(pose.yaw),
        left_velocity=round(speed - half_difference),
        right_velocity=round(speed + half_difference),
        battery=min(battery, 0xFF),
        left_stall=bumpers.stalled | bumpers.rear << 1,
        right_stall=bumpers.stalled | bumpers.front << 1,
        control=_steps(odometer.heading_of(controller.drive.setpoint)),
        flags=controller.flags,
        sonar=controller.sonar.take(),
        analog_port=controller.analog_port,
        digital_out=controller.digital_out,
        battery_x10=battery,
        rotational_velocity=round(math.degrees(spin) * 10),
        charge_percent=max(round(controller.charge * 100), 1),
    )


def configuration(controller: Controller, watchdog: float) -> Config:
    """Return the configuration with the bounds in force; the watchdog in [s]."""
    velocity, acceleration, deceleration = controller.drive.translation.figures
    rotation_velocity, rotation_acceleration, rotation_deceleration = controller.drive.rotation.figures
    return replace(
        controller.model.config,
        watchdog=round(watchdog * 1000),
        velocity_max=velocity,
        acceleration=acceleration,
        deceleration=deceleration,
        rotation_velocity_max=rotation_velocity,
        rotation_acceleration=rotation_acceleration,
        rotation_deceleration=rotation_deceleration,
        sonar_cycle=min(controller.sonar.cycle_ms, 0xFF),
        aux1_baud=controller.aux[0].baud,
        aux2_baud=controller.aux[1].baud,
        aux3_baud=controller.aux[2].baud,
    )


def extras(controller: Controller) -> bytes:
    """Return the packets beside the information packet that are wanted now: encoders, inputs, auxiliary ports."""
    packets = b"".join(port.answer() for port in controller.aux)
    if controller.encoder_packets:
        packets += encode_encoders(Encoders(*controller.odometer.ticks))
        controller.encoder_packets &= 2
    if controller.io_packets:
        packets += _inputs(controller)
        controller.io_packets &= 2
    return packets


def _inputs(controller: Controller) -> bytes:
    """Return an IO packet: four bytes of inputs, one of outputs, nine analog values with the battery's at the end."""
    bumpers, battery = controller.bumpers, round(controller.voltage / 20 * 1023)
    inputs = (4, 0, bumpers.front << 1, bumpers.rear << 1, 0)
    return encode(bytes((PacketType.IO,)) + _IO.pack(*inputs, 1, controller.digital_out, 9, *(0,) * 8, battery))


def _steps(angle: float) -> int:
    """Return an angle in -pi..pi as the protocol's units, -2048..2047."""
    half = ANGLE_STEPS // 2
    return (round(angle / math.tau * ANGLE_STEPS) + half) % ANGLE_STEPS - half
