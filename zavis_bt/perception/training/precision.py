"""Sixteen-bit arithmetic where the processor has it: networks train faster, and learn the same."""

from __future__ import annotations

from contextlib import AbstractContextManager, nullcontext

import torch


def mixed_precision(device: str) -> AbstractContextManager[object]:
    """Return a context in which products of a network are made of sixteen-bit numbers, where that is faster.

    On a GPU they are torch's float16 (with a gradient scaler beside), on a CPU that multiplies them bfloat16; elsewhere
    nothing changes.
    """
    if device.startswith("cuda"):
        return torch.autocast("cuda")
    if torch.cpu.get_capabilities().get("avx512_bf16") or torch.cpu.get_capabilities().get("amx_bf16"):
        return torch.autocast("cpu", dtype=torch.bfloat16)
    return nullcontext()
