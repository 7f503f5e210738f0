#!/usr/bin/env python3
"""Writes a terrain of 1024 x 1024 samples, 1 m apart: the canyon of data/heightmaps, mirrored to the east and the south.

Usage: make_large_canyon.py FILE.exr
"""
import struct
import sys
import zlib
from pathlib import Path

import numpy as np

HEIGHTMAPS = Path(__file__).resolve().parents[1] / "data/heightmaps"
sys.dont_write_bytecode = True
sys.path.insert(0, str(HEIGHTMAPS))
from make_canyon import SIZE, write_exr  # noqa: E402

LINES = 16  # of a ZIP block


def read_exr(path):
    """What write_exr wrote: ZIP blocks of one float channel, SIZE x SIZE."""
    data = path.read_bytes()
    last = b"screenWindowWidth\0float\0"
    table = data.index(last) + len(last) + 4 + 4 + 1  # its size and value, and the end of the header
    rows = []
    for (start,) in struct.iter_unpack("<Q", data[table : table + 8 * (SIZE // LINES)]):
        size = struct.unpack_from("<i", data, start + 4)[0]
        raw = np.frombuffer(data, np.uint8, size, start + 8)
        if size < 4 * SIZE * LINES:
            delta = np.frombuffer(zlib.decompress(raw.tobytes()), np.uint8).astype(np.int64)
            split = (np.cumsum(delta) - 128 * np.arange(delta.size)) & 255
            raw = split.astype(np.uint8).reshape(2, -1).T.ravel()
        rows.append(raw.view("<f4").reshape(LINES, SIZE))
    return np.concatenate(rows)


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__.strip())
    h = read_exr(HEIGHTMAPS / "canyon.exr")
    h = np.hstack([h, h[:, ::-1]])
    write_exr(Path(sys.argv[1]), np.vstack([h, h[::-1]]))


if __name__ == "__main__":
    main()
