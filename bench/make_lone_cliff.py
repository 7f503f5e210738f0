#!/usr/bin/env python3
"""Writes a terrain of 1024 x 1024 samples, 1 m apart: gentle hills around one cliff, 30 m high and 60 m long.

Usage: make_lone_cliff.py FILE.exr

The cliff stands in the middle 96 m x 96 m, and nothing outside is steeper than 31 degrees.
"""
import sys
from pathlib import Path

import numpy as np

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "data/heightmaps"))
from make_canyon import write_exr  # noqa: E402

SAMPLES = 1024
HEIGHT = 30.0  # Metres.


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__.strip())
    y, x = np.mgrid[0:SAMPLES, 0:SAMPLES] - 0.5 * (SAMPLES - 1)
    hills = 6.0 * np.sin(x / 70.0) * np.sin(y / 55.0)
    # A step that fades along its length and to both sides within some hundred metres.
    step = np.tanh(x / 6.0) * np.exp(-np.square(y / 40.0) ** 2) * np.exp(-np.square(np.maximum(np.abs(x) - 20.0, 0.0) / 120.0))
    write_exr(Path(sys.argv[1]), hills + 0.5 * HEIGHT * step)


if __name__ == "__main__":
    main()
