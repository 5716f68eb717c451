"""ARCOS packets, both directions, as pure functions.

``encode_…`` return whole packets, ready for the line; ``decode_…`` take the payloads that `PacketDecoder` finds.
"""

from drivers.pioneer.codec.commands import (
    BAUD_CODES,
    MAX_STRING,
    Command,
    CommandNumber,
    decode_command,
    encode_command,
    encode_wheels,
)
from drivers.pioneer.codec.config import CONFIG_TYPE, Config, decode_config, encode_config
from drivers.pioneer.codec.errors import PacketError
from drivers.pioneer.codec.framing import MAX_PACKET, MAX_PAYLOAD, PacketDecoder, checksum, encode
from drivers.pioneer.codec.others import (
    AuxData,
    Encoders,
    PacketType,
    decode_aux,
    decode_encoders,
    encode_aux,
    encode_encoders,
)
from drivers.pioneer.codec.sip import ANGLE_STEPS, Flags, Sip, decode_sip, encode_sip, is_sip
from drivers.pioneer.codec.sync import Identity, decode_identity, encode_identity, encode_sync, sync_number

__all__ = [
    "ANGLE_STEPS",
    "BAUD_CODES",
    "CONFIG_TYPE",
    "MAX_PACKET",
    "MAX_PAYLOAD",
    "MAX_STRING",
    "AuxData",
    "Command",
    "CommandNumber",
    "Config",
    "Encoders",
    "Flags",
    "Identity",
    "PacketDecoder",
    "PacketError",
    "PacketType",
    "Sip",
    "checksum",
    "decode_aux",
    "decode_command",
    "decode_config",
    "decode_encoders",
    "decode_identity",
    "decode_sip",
    "encode",
    "encode_aux",
    "encode_command",
    "encode_config",
    "encode_encoders",
    "encode_identity",
    "encode_sip",
    "encode_sync",
    "encode_wheels",
    "is_sip",
    "sync_number",
]
