#!/usr/bin/env python3
"""Makes cliff.exr and towers.exr: 113 x 81 elevations 1 m apart each, for the pictures of docs/gallery.md.

    cliff     A wall of 36 m faces south, with a spur, a gully that cuts in behind it and a ledge that comes and goes;
              scree lies at its foot, a gentle slope on its top.
    towers    A group of rock towers with upright walls, up to 45 m, parted by clefts in two directions, on
              scree.

They say nothing of the rock: blocks and beds are what a strata file adds. `amplify --cell-size S --height-scale S`
makes them S times as large, as rock asks for. All shapes are functions of the distance to the walls' upper edges.

Usage: make_cliff.py [FOLDER]     (default: the folder of this file)
Needs Python 3.9 with numpy 1.20 or newer.
"""
import sys
from pathlib import Path

import numpy as np

from make_canyon import blur, fourier_noise, write_exr

WIDTH, DEPTH = 113, 81  # samples
TOP = 40.0  # m, the wall's upper edge
FOOT = 4.0  # m, where the wall ends in scree
WALL_DEG, SCREE_DEG, TOP_DEG = 80.0, 33.0, 9.0
LEDGE, LEDGE_WIDTH = 25.0, 3.5  # m, height and greatest width
# East, north, half widths along and across the clefts, height: m.
TOWERS = [
    (40.0, 37.0, 7.0, 6.0, 45.0),
    (53.5, 43.0, 4.5, 7.0, 50.0),
    (36.0, 50.5, 6.0, 5.5, 36.0),
    (64.0, 36.0, 4.0, 4.0, 33.0),
    (68.0, 51.0, 7.0, 6.0, 41.0),
    (27.0, 41.0, 3.0, 3.5, 26.0),
    (79.0, 44.0, 3.5, 3.0, 24.0),
    (52.0, 57.0, 6.0, 4.0, 40.0),
]
CLEFTS_DEG, TOWER_WALL_DEG = 25.0, 84.0  # azimuth of the clefts


def edge(x):
    """Northing of the wall's upper edge."""
    spur = 11.0 * np.exp(-(((x - 38.0) / 11.0) ** 4))
    gully = 13.0 * np.exp(-(((x - 62.0) / 4.5) ** 2))
    return 46.0 - spur + gully + 1.6 * fourier_noise(71, x, 0.0 * x, 38.0, 3)


def cliff():
    x, y = np.meshgrid(np.arange(WIDTH, dtype=float), np.arange(DEPTH, dtype=float))
    line = np.linspace(-40.0, WIDTH + 40.0, 1500)
    rim = edge(line)
    inside = np.sqrt(((x[..., None] - line) ** 2 + (y[..., None] - rim) ** 2).min(axis=2))
    inside = np.where(y > np.interp(x, line, rim), inside, -inside)  # m behind the edge
    # From the edge down: wall, ledge, wall, scree.
    out = np.maximum(-inside, 0.0)
    ledge = LEDGE_WIDTH * np.clip(0.6 + 0.7 * fourier_noise(72, x, y, 33.0, 2), 0.0, 1.0)
    level = LEDGE + 1.2 * fourier_noise(73, x, y, 50.0, 2)
    steep = np.tan(np.radians(WALL_DEG))
    upper = TOP - steep * out
    lower = level - steep * np.maximum(out - (TOP - level) / steep - ledge, 0.0) - 0.25 * out
    wall = np.maximum(upper, np.minimum(lower, level))
    reach = (TOP - FOOT) / steep + LEDGE_WIDTH
    fan = 3.0 * fourier_noise(74, x, y, 30.0, 2) + 5.0 * np.exp(-(((x - 62.0) / 8.0) ** 2))
    scree = FOOT + fan + np.tan(np.radians(SCREE_DEG)) * (reach - out)
    scree = np.maximum(scree, 0.06 * y + 0.5 * fourier_noise(75, x, y, 25.0, 2))
    bumps = 0.5 * fourier_noise(76, x, y, 22.0, 3) * np.clip(inside / 8.0, 0.0, 1.0)
    top = TOP + np.tan(np.radians(TOP_DEG)) * inside + bumps
    height = np.where(inside > 0.0, top, np.maximum(wall, scree))
    return blur(height, 0.55)[::-1]  # row 0 is the north edge


def towers():
    x, y = np.meshgrid(np.arange(WIDTH, dtype=float), np.arange(DEPTH, dtype=float))
    a = np.radians(CLEFTS_DEG)
    height = np.zeros_like(x)
    nearest = np.full_like(x, 1e9)
    for k, (east, north, across, along, top) in enumerate(TOWERS):
        dx, dy = x - east, y - north
        u = np.abs(dx * np.cos(a) - dy * np.sin(a)) - across + 0.7 * fourier_noise(80 + k, x, y, 20.0, 2)
        v = np.abs(dx * np.sin(a) + dy * np.cos(a)) - along + 0.7 * fourier_noise(90 + k, x, y, 20.0, 2)
        # The distance to a box; corners of 1.5 m.
        distance = np.hypot(np.maximum(u + 1.5, 0.0), np.maximum(v + 1.5, 0.0)) - 1.5
        distance += np.minimum(np.maximum(u, v) + 1.5, 0.0)
        roof = top + 0.35 * np.minimum(-distance, 5.0) + 0.8 * fourier_noise(100 + k, x, y, 14.0, 2)
        height = np.maximum(height, np.where(distance < 0.0, roof, top - np.tan(np.radians(TOWER_WALL_DEG)) * distance))
        nearest = np.minimum(nearest, distance)
    centre = np.hypot((x - 52.0) / 1.35, y - 46.0)
    scree = 16.0 - 0.42 * np.maximum(centre - 14.0, 0.0) - 0.1 * nearest + 0.6 * fourier_noise(110, x, y, 28.0, 3)
    return blur(np.maximum(height, np.maximum(scree, 0.05 * y)), 0.45)[::-1]


def main():
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parent
    for make in (cliff, towers):
        path = folder / f"{make.__name__}.exr"
        h = np.round(make() * 128) / 128
        write_exr(path, h.astype(np.float32), b"Elevations in metres, 1 m apart; made by make_cliff.py.")
        slope = np.degrees(np.arctan(np.hypot(*np.gradient(h))))
        print(f"{path.name}: {h.min():.1f} to {h.max():.1f} m, {100 * (slope > 45).mean():.0f} % steeper than 45 "
              f"degrees, {100 * (slope > 70).mean():.0f} % than 70, {path.stat().st_size // 1024} KiB")


if __name__ == "__main__":
    main()
