"""SCIP 2.0 as pure functions: lines, numbers, requests, answers, readings."""

from drivers.lidar.codec.answers import Answer, AnswerDecoder, encode_answer
from drivers.lidar.codec.blocks import pack_block, unpack_block
from drivers.lidar.codec.errors import CodecError
from drivers.lidar.codec.information import Parameters, decode_information, encode_information
from drivers.lidar.codec.lines import checksum, seal, seal_information, unseal, unseal_information
from drivers.lidar.codec.numbers import (
    CLOCK_DIGITS,
    CLOCK_SPAN,
    decode_number,
    encode_number,
    encode_numbers,
    join_digits,
)
from drivers.lidar.codec.requests import PARAMETERS, SCAN_COMMANDS, Request, RequestError, ScanRequest, parse_request
from drivers.lidar.codec.scans import Readings, decode_readings, encode_readings

__all__ = [
    "CLOCK_DIGITS",
    "CLOCK_SPAN",
    "PARAMETERS",
    "SCAN_COMMANDS",
    "Answer",
    "AnswerDecoder",
    "CodecError",
    "Parameters",
    "Readings",
    "Request",
    "RequestError",
    "ScanRequest",
    "checksum",
    "decode_information",
    "decode_number",
    "decode_readings",
    "encode_answer",
    "encode_information",
    "encode_number",
    "encode_numbers",
    "encode_readings",
    "join_digits",
    "pack_block",
    "parse_request",
    "seal",
    "seal_information",
    "unpack_block",
    "unseal",
    "unseal_information",
]
