"""Blocks of a container that are compressed each for itself, unpacked within what they declare."""

from __future__ import annotations

import importlib
import zlib
from io import BytesIO

#: Compressions by the bytes they begin with: zlib with its usual window, Zstandard, an LZ4 frame.
_ZLIB, _ZSTD, _LZ4 = b"\x78", b"\x28\xb5\x2f\xfd", b"\x04\x22\x4d\x18"


def unpack(packed: bytes, size: int) -> bytes:
    """Content of a block that declares `size` bytes.

    Raises:
        ValueError: it holds more, or is packed in a way that is not known.
    """
    if packed.startswith(_ZLIB):
        content = zlib.decompressobj().decompress(packed, size + 1)
    elif packed.startswith(_ZSTD):
        decompressor = importlib.import_module("zstandard").ZstdDecompressor()
        content = decompressor.stream_reader(packed, read_across_frames=True).read(size + 1)
    elif packed.startswith(_LZ4):
        content = importlib.import_module("lz4.frame").LZ4FrameFile(BytesIO(packed)).read(size + 1)
    else:
        raise ValueError(f"a block is packed in an unknown way (0x{packed[:4].hex()})")
    if len(content) > size:
        raise ValueError(f"a block holds more than the {size} bytes it declares")
    return content
