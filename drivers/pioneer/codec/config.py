"""Configuration packet (CONFIGpac): the robot's name plate, limits and settings, sent once when asked for."""

from __future__ import annotations

from dataclasses import astuple, dataclass
from functools import cache
from struct import Struct
from struct import error as StructError
from typing import Annotated, Any, get_type_hints

from drivers.pioneer.codec.errors import PacketError
from drivers.pioneer.codec.framing import encode
from drivers.pioneer.codec.sync import decode_text, encode_text

CONFIG_TYPE = 0x20

Text = Annotated[str, ""]
U8 = Annotated[int, "<B"]
I8 = Annotated[int, "<b"]
U16 = Annotated[int, "<H"]
I16 = Annotated[int, "<h"]
U32 = Annotated[int, "<I"]


@dataclass(frozen=True, slots=True)
class Config:
    """A CONFIGpac, fields in the order of the packet; velocities [mm/s, deg/s], accelerations [mm/s², deg/s²].

    The defaults are plausible values of a Pioneer 3-AT. In a packet that ends early the rest is zero or empty.
    """

    class_name: Text = "Pioneer"
    subclass: Text = "p3at-sh"
    serial_number: Text = ""
    four_motors: U8 = 0
    rotation_velocity_top: U16 = 300
    """Absolute bound, as are the next three."""
    velocity_top: U16 = 1200
    rotation_acceleration_top: U16 = 600
    acceleration_top: U16 = 4000
    pwm_max: U16 = 500
    name: Text = ""
    sip_cycle: U8 = 100
    """[ms]"""
    host_baud: U8 = 0
    """Code of HOSTBAUD, as the next one."""
    aux1_baud: U8 = 0
    gripper: U16 = 0
    front_sonar: U16 = 1
    rear_sonar: U8 = 1
    low_battery: U16 = 110
    """[0.1 V]"""
    rev_count: U16 = 32550
    watchdog: U16 = 2000
    """Silence of the client after which the robot stops [ms]; 0 = never."""
    alternative_sip: U8 = 0
    stall_value: U16 = 200
    """[PWM]"""
    stall_count: U16 = 200
    """[ms]"""
    joystick_velocity: U16 = 750
    joystick_rotation_velocity: U16 = 50
    rotation_velocity_max: U16 = 100
    """Current bound, as are the next three."""
    velocity_max: U16 = 750
    rotation_acceleration: U16 = 100
    rotation_deceleration: U16 = 100
    rotation_kp: U16 = 40
    rotation_kv: U16 = 20
    rotation_ki: U16 = 0
    acceleration: U16 = 300
    deceleration: U16 = 300
    translation_kp: U16 = 40
    translation_kv: U16 = 30
    translation_ki: U16 = 0
    front_bumpers: U8 = 0
    """Number of segments."""
    rear_bumpers: U8 = 0
    charger: U8 = 0
    sonar_cycle: U8 = 40
    """[ms]"""
    autobaud: U8 = 1
    """1: HOSTBAUD can change the speed; 2: and the robot falls back by itself."""
    gyro: U8 = 0
    drift_factor: I16 = 0
    aux2_baud: U8 = 0
    aux3_baud: U8 = 0
    ticks_per_mm: U16 = 138
    shutdown_voltage: U16 = 110
    """[0.1 V]"""
    firmware: Text = "2.6"
    gyro_clockwise: U16 = 0
    gyro_counter_clockwise: U16 = 0
    kinematics_delay: U8 = 0
    """[ms]"""
    lateral_velocity_top: U16 = 0
    lateral_acceleration_top: U16 = 0
    lateral_velocity_max: U16 = 0
    lateral_acceleration: U16 = 0
    lateral_deceleration: U16 = 0
    charge_threshold: U16 = 0
    power_port: U8 = 0
    gyro_rate_limit: U16 = 0
    high_temperature: I8 = -128
    """[degree C]; -128 = none."""
    power_bits: U16 = 0
    battery_type: U8 = 0
    charge_low: U16 = 0
    """[%]"""
    charge_shutdown: U16 = 0
    """[%]"""
    boot_loader: Text = ""
    config_flags: U32 = 0
    gyro_firmware: I16 = 0


@cache
def _layout() -> tuple[tuple[str, Struct | None], ...]:
    """Name and number format of each field, in order; None for texts."""
    hints = get_type_hints(Config, include_extras=True)
    codes = ((name, hint.__metadata__[0]) for name, hint in hints.items())
    return tuple((name, Struct(code) if code else None) for name, code in codes)


def encode_config(config: Config) -> bytes:
    """Return the packet of a configuration.

    Raises:
        ValueError: A number is out of range, a text is not ASCII, or all texts together are too long.
    """
    payload = bytes((CONFIG_TYPE,))
    for (name, number), value in zip(_layout(), astuple(config), strict=True):
        try:
            payload += number.pack(value) if number else encode_text(value)
        except StructError as error:
            raise ValueError(f"{name} of the configuration is out of range: {value}") from error
    return encode(payload)


def decode_config(payload: bytes) -> Config:
    """Return the configuration in a payload; what is missing at its end is zero or empty.

    Raises:
        PacketError: It is no CONFIGpac.
    """
    if payload[:1] != bytes((CONFIG_TYPE,)):
        raise PacketError("is no CONFIGpac")
    rest = payload[1:]
    values: dict[str, Any] = {}  # texts and numbers, as `_layout` says
    for name, number in _layout():
        if number is None:
            text, _, rest = rest.partition(b"\0")
            values[name] = decode_text(text)
        else:
            values[name] = number.unpack_from(rest)[0] if len(rest) >= number.size else 0
            rest = rest[number.size :]
    return Config(**values)
