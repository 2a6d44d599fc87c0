"""A block of a study as bytes: arrays and notes, behind their digest."""

from __future__ import annotations

import hashlib
import io
import json

import numpy as np

from core.plan.pieces import Computed

DIGEST = 32  # bytes of a SHA-256, in front of a block
_NOTES = "notes"


def pack(computed: Computed) -> tuple[bytes, memoryview]:
    """Return what was computed of a piece as a digest and the bytes that follow it."""
    notes = np.frombuffer(json.dumps(dict(computed.notes)).encode(), np.uint8)
    content = io.BytesIO()
    np.savez(content, allow_pickle=False, **{_NOTES: notes}, **computed.arrays)
    return hashlib.sha256(content.getbuffer()).digest(), content.getbuffer()


def unpack(block: bytes) -> Computed | None:
    """Return what was computed of a piece; None if its digest is another one."""
    view = memoryview(block)
    digest, content = view[:DIGEST], view[DIGEST:]
    if hashlib.sha256(content).digest() != digest:
        return None
    with np.load(io.BytesIO(content), allow_pickle=False) as file:
        arrays = dict(file)
    notes = json.loads(arrays.pop(_NOTES).tobytes())
    return Computed(arrays, notes)
