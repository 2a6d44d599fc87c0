"""Blocks of studies on disk: arrays and notes, each file behind its digest."""

from __future__ import annotations

import hashlib
import io
import json
from pathlib import Path

import numpy as np

from vibrafeed.app.jobs.errors import TornBlockError
from vibrafeed.app.jobs.studies import Studies
from vibrafeed.core.code_version import code_version
from vibrafeed.core.dataset.files import whole
from vibrafeed.core.plan.pieces import Computed

DIGEST = 32  # bytes of the SHA-256 that a block's file begins with
_NOTES = "notes"


def pack(computed: Computed) -> tuple[bytes, memoryview]:
    """Return the digest of a block's content and the content, as they are written to its file.

    The digest is a SHA-256 of 32 bytes; the content holds the computed arrays and notes in the
    format of `numpy.savez`.
    """
    notes = np.frombuffer(json.dumps(dict(computed.notes)).encode(), np.uint8)
    content = io.BytesIO()
    np.savez(content, allow_pickle=False, **{_NOTES: notes}, **computed.arrays)
    return hashlib.sha256(content.getbuffer()).digest(), content.getbuffer()


def unpack(block: bytes) -> Computed | None:
    """Return the arrays and notes in the bytes of a block's file.

    None if its digest does not match.
    """
    view = memoryview(block)
    digest, content = view[:DIGEST], view[DIGEST:]
    if hashlib.sha256(content).digest() != digest:
        return None
    with np.load(io.BytesIO(content), allow_pickle=False) as file:
        arrays = dict(file)
    notes = json.loads(arrays.pop(_NOTES).tobytes())
    return Computed(arrays, notes)


class Blocks(Studies):
    """Keeps studies, and the blocks that are computed of them, in a folder within each."""

    def has_block(self, key: str, cells: int, index: int) -> bool:
        """True if a block of a study is stored; `cells` is the size of a block."""
        return self._block_file(key, cells, index).exists()

    def write_block(self, key: str, cells: int, index: int, computed: Computed) -> None:
        """Store the computed arrays of a block on disk.

        Parameters
        ----------
        key : str
            Identifier of the study.
        cells : int
            Cells per block; blocks of another size are kept apart.
        index : int
            Number of the block, from 0.
        computed : Computed
            Its arrays and notes.
        """
        path = self._block_file(key, cells, index)
        digest, content = pack(computed)
        for is_last_try in (False, True):
            # Not the study's own folder: if that is gone, so is the study.
            path.parent.parent.mkdir(exist_ok=True)
            path.parent.mkdir(exist_ok=True)
            try:
                with whole(path) as temporary, temporary.open("wb") as file:
                    file.write(digest)
                    file.write(content)
            except FileNotFoundError:  # another worker finished the study and removed its blocks
                if is_last_try:
                    raise
            else:
                return

    def read_block(self, key: str, cells: int, index: int) -> Computed:
        """Return the arrays of a block; raise `TornBlockError` if the block is missing or damaged.

        A damaged block is removed, so that it is computed again. `key` is the study's identifier,
        `cells` the number of cells of a block, and `index` the block's number from 0.
        """
        path = self._block_file(key, cells, index)
        try:
            block = path.read_bytes()
        except FileNotFoundError:
            raise TornBlockError(f"block {index} of {key} is gone") from None
        computed = unpack(block)
        if computed is None:
            path.unlink(missing_ok=True)
            raise TornBlockError(
                f"block {index} of study {key} was damaged on the disk; it is computed again"
            )
        return computed

    def _block_file(self, key: str, cells: int, index: int) -> Path:
        """Return the path of a block's file: of a study, cells per block, and number from 0."""
        # Blocks of another size, left by a job that was given up, are never taken for these; nor
        # are those of other code, so that no result is made by two.
        size_and_code = f"{cells}-{code_version()}"
        return self.folder(key) / "blocks" / size_and_code / f"{index:06d}.block"
