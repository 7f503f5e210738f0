#!/usr/bin/env python3
"""Makes canyon.exr: a canyon in layered rock, 512 x 512 elevations 1 m apart, shaped by uplift, rivers and slopes.

A plateau of alternating hard and soft beds rises slowly while a meandering river holds its level; what is left after
the river has cut down, its tributaries have followed and the walls have come back is the canyon.

    Rivers    Tributaries follow the detachment-limited stream power law, dz/dt = U - K A^m S^n with n = 1, m = 0.45
              (Whipple and Tucker 1999) above a threshold, solved implicitly from the outlet upwards (Braun and Willett
              2013) along the steepest descent to eight neighbours, which is perturbed at random (Fairfield and
              Leymarie 1991), so that no direction of the grid is preferred. K follows the rock. The main river comes
              from outside with its meanders, which grow as it cuts down; three pauses leave knickpoints and ledges.
    Slopes    Rock holds up to a threshold slope and fails above it at a rate, both of its own layer: hard beds hold
              58 to 80 degrees, soft ones 24 to 36. Cliffs retreat by the failure of what lies below them, so that hard
              beds stand as walls and soft ones form benches. Thickness, hardness and joint density vary laterally, or
              every bed would draw a contour line. Close below the old surface all rock is weathered, so that rims are
              rounded. Soil creeps: diffusion (Culling 1963).
    Scree     Part of what falls comes to rest at the angle of repose at the foot of the walls, is spread by exchange
              between neighbours (Musgrave, Kolb and Mace 1989), protects the rock below and is carried off by rivers.

The same layers, with dip and dip direction, stand in data/strata/canyon.json; `LAYERS` below is their source.
Coarse first (2 m cells), then fine (1 m cells). Seeded; 50 s on one core. Another numpy may round elsewhere and give
another canyon of the same kind: the file in the repository is the one that tests and pictures refer to.

Usage: make_canyon.py [FILE]     (default: canyon.exr in the folder of this file)
Needs Python 3.9 with numpy 1.20 or newer.
"""
import struct
import sys
import zlib
from pathlib import Path

import numpy as np

SIZE = 512  # samples a side
CELL = 1.0  # metres
PLATEAU = 1384.0  # m, mean elevation of the uncut plateau
RIVER_START, RIVER_END = 1376.0, 1222.0  # m, level of the river where it leaves, first and last
RIVER_SLOPE = 0.012
DIP_DEG, DIP_DIRECTION_DEG = 2.5, 60.0  # of all layers; the plane passes through the map's south-west corner

# Bottom to top: material, top [m, at the south-west corner], threshold slopes [deg] weakest to strongest, erodibility
# relative to the hardest, share of an excess that fails in a step.
LAYERS = [
    ("basement", 1236.0, (58, 78), 1.0, 0.22),
    ("shale", 1260.0, (25, 34), 5.0, 0.5),
    ("massive", 1304.0, (65, 80), 1.3, 0.2),
    ("thin_bedded", 1313.0, (40, 70), 2.2, 0.3),
    ("shale", 1333.0, (24, 33), 5.0, 0.5),
    ("massive", 1362.0, (63, 80), 1.2, 0.2),
    ("shale", 1370.0, (26, 36), 3.5, 0.5),
    ("thin_bedded", 9999.0, (42, 74), 1.2, 0.3),
]
M_AREA = 0.45  # m of the stream power law
K_STREAM = 0.013  # m^(1 - 2m) a step, hardest rock
AREA_CRITICAL = 15.0  # m², smaller catchments cut nothing: their water seeps away
THRESHOLD = 0.05  # m a step that a stream must be able to cut before it cuts at all
RIVER_HALF_WIDTH = 8.0  # m
STEPS = {2: 260, 1: 70}  # steps by stride of the grid
REROUTE = 3  # steps between two looks at where the water runs
CREEP = {2: 0.018, 1: 0.02}  # share of the curvature that soil creep levels in a step
SCREE_SHARE = 0.6  # of the failed rock that stays as scree
REPOSE = np.tan(np.radians(35.5))
NEIGHBOURS = [(0, 1), (1, 1), (1, 0), (1, -1), (0, -1), (-1, -1), (-1, 0), (-1, 1)]  # (row, column), reverse is +4
KNIGHTS = [(1, 2), (2, 1), (2, -1), (1, -2), (-1, -2), (-2, -1), (-2, 1), (-1, 2)]


# ---- noise that does not depend on the grid's spacing ----


def fourier_noise(seed, x, y, wavelength, octaves=4, gain=0.5, stretch=1.0, azimuth_deg=0.0):
    """Noise of unit deviation at (x, y) metres; wavelengths from `wavelength` down, longer along `azimuth_deg`."""
    rng = np.random.Generator(np.random.Philox(seed))
    a = np.radians(azimuth_deg)
    along, across = x * np.sin(a) + y * np.cos(a), x * np.cos(a) - y * np.sin(a)
    total, power = np.zeros_like(x), 0.0
    for octave in range(octaves):
        k0 = 2 * np.pi * 2**octave / wavelength
        for _ in range(20):
            angle, k = rng.random() * 2 * np.pi, k0 * rng.uniform(0.7, 1.4)
            phase = rng.random() * 2 * np.pi
            total += gain**octave * np.cos(k * (np.cos(angle) * along / stretch + np.sin(angle) * across) + phase)
            power += 0.5 * gain ** (2 * octave)
    return total / np.sqrt(power)


def blur(h, sigma):
    """Gaussian blur with mirrored borders, sigma in samples."""
    n = int(3 * sigma + 1)
    kernel = np.exp(-0.5 * (np.arange(-n, n + 1) / sigma) ** 2)
    kernel /= kernel.sum()
    for _ in range(2):
        padded = np.pad(h, ((n, n), (0, 0)), mode="symmetric")
        h = sum(kernel[i] * padded[i : i + h.shape[0]] for i in range(2 * n + 1)).T
    return h


# ---- the rock ----


class Rock:
    """Layers with everything that varies sideways, on a grid of the given stride."""

    def __init__(self, x, y):
        self.dip = -np.tan(np.radians(DIP_DEG)) * (
            x * np.sin(np.radians(DIP_DIRECTION_DEG)) + y * np.cos(np.radians(DIP_DIRECTION_DEG))
        )
        # boundaries wander: beds thin out and thicken
        self.tops = np.stack(
            [layer[1] + self.dip + 1.3 * fourier_noise(40 + k, x, y, 130, 3) for k, layer in enumerate(LAYERS[:-1])]
        )
        self.weak = np.radians([angles[0] for _, _, angles, _, _ in LAYERS])
        self.strong = np.radians([angles[1] for _, _, angles, _, _ in LAYERS])
        self.erodibility = np.array([k for _, _, _, k, _ in LAYERS])
        self.failing = np.array([r for _, _, _, _, r in LAYERS])
        # Joint density: corridors of two steep sets, and patches. High: weak.
        corridors = fourier_noise(11, x, y, 46, 3, 0.6, 5.0, 32.0), fourier_noise(12, x, y, 60, 3, 0.6, 5.0, 104.0)
        self.jointed = 0.42 * corridors[0] + 0.36 * corridors[1] + 0.55 * fourier_noise(13, x, y, 90, 5, 0.62)
        self.surface = plateau(x, y)
        self.weathered = 5.5 + 2.0 * fourier_noise(15, x, y, 60, 3)
        self.weathered = np.clip(self.weathered, 1.5, None)
        self.ledges = [fourier_noise(20 + k, x, y, 75, 4, 0.6) for k in range(3)]

    def at(self, z):
        """Tangent of the threshold slope, erodibility and failing share of the rock at elevation z."""
        layer = (z > self.tops).sum(0)
        s = z - self.dip
        # courses within a layer, hard and soft, that fade in and out sideways
        courses = (
            np.sin(s * (2 * np.pi / 15.7) + 1.5 * self.ledges[0]) * np.clip(self.ledges[1], 0, 1)
            + np.sin(s * (2 * np.pi / 8.9) + 2.0 * self.ledges[2]) * np.clip(self.ledges[0], 0, 1)
        )
        strength = 1 / (1 + np.exp(2.6 * self.jointed + 1.5 * courses))
        angle = self.weak[layer] + (self.strong[layer] - self.weak[layer]) * strength
        # close below the old surface all rock is weathered: rims are rounded
        fresh = np.clip((self.surface - z) / self.weathered, 0.0, 1.0)
        angle = np.radians(34) + (angle - np.radians(34)) * fresh * fresh
        erodibility = self.erodibility[layer] * (2.2 - 1.8 * strength)
        return np.tan(angle), erodibility, self.failing[layer] * (1.5 - 1.0 * strength)


# ---- rivers ----


def river_y(x, progress):
    """Where the main river runs (y, metres, for x) when it has cut the share `progress` of its way: meanders grow."""
    grow = 0.55 + 0.45 * progress
    shift = 14 * progress
    return (
        258
        + grow * 62 * np.sin(2 * np.pi * (x - 40 - shift) / 390)
        + grow * 24 * np.sin(2 * np.pi * (x - 10 - 0.7 * shift) / 171 + 0.8)
        + 6 * np.sin(2 * np.pi * (x - shift) / 73 + 2.1)
    )


def river_level(progress):
    """Level of the river at the outlet: it cuts down, and pauses three times."""
    times = [0.0, 0.16, 0.24, 0.46, 0.56, 0.74, 0.80, 0.93, 1.0]
    share = [0.0, 0.22, 0.235, 0.50, 0.515, 0.79, 0.80, 1.0, 1.0]
    return RIVER_START + (RIVER_END - RIVER_START) * np.interp(progress, times, share)


# Streams that come in from the plateau's edges: x, y of the entry [m], catchment outside the map [m²].
INFLOWS = [(118, 511, 3e5), (322, 511, 5e4), (430, 511, 1.5e5), (60, 0, 6e4), (232, 0, 4e5), (390, 0, 1e5)]


def fill_pits(h, outlet):
    """Raises pits so that every cell drains to `outlet`: from above, in sweeps (Planchon and Darboux 2001)."""
    w = np.where(outlet, h, 1e9)
    while True:
        before = w.copy()
        for view, ground in ((w, h), (w[::-1], h[::-1]), (w.T, h.T), (w.T[::-1], h.T[::-1])):
            for row in range(1, len(view)):
                last = view[row - 1]
                low = np.minimum(last, view[row])
                np.minimum(low[1:], last[:-1], out=low[1:])
                np.minimum(low[:-1], last[1:], out=low[:-1])
                np.minimum(view[row], np.maximum(ground[row], low + 1e-3), out=view[row])
        if np.array_equal(w, before):
            return w


def drainage(h, outlet, cell, rng):
    """Receiver of each cell and cells by distance from the outlet along the flow, nearest first."""
    n, m = h.shape
    padded = np.pad(h, 1, constant_values=1e9)
    best = np.full(h.shape, -1e9)
    receiver = np.arange(n * m).reshape(n, m)
    index = np.pad(receiver, 1)
    for r, c in NEIGHBOURS:
        drop = (h - padded[1 + r : 1 + r + n, 1 + c : 1 + c + m]) / (cell * np.hypot(r, c))
        score = drop * np.where(drop > 0, 1 / (1 - 0.45 * rng.random(h.shape)), 1)
        better = (score > best) & (drop > 0)
        best = np.where(better, score, best)
        receiver = np.where(better, index[1 + r : 1 + r + n, 1 + c : 1 + c + m], receiver)
    receiver = np.where(outlet, np.arange(n * m).reshape(n, m), receiver).ravel()
    depth = (receiver != np.arange(n * m)).astype(np.int32)
    jump = receiver
    while True:  # pointer doubling: steps to the root
        further = depth[jump]
        if not further.any():
            break
        depth = depth + further
        jump = jump[jump]
    order = np.argsort(depth, kind="stable")
    ends = np.searchsorted(depth[order], np.arange(depth.max() + 2))
    return receiver, [order[a:b] for a, b in zip(ends[1:-1], ends[2:])]


def accumulate(receiver, levels, area):
    """Adds each cell's area to its receiver's, farthest first."""
    for cells in reversed(levels):
        np.add.at(area, receiver[cells], area[cells])
    return area


def incise(h, erodibility, receiver, levels, area, cell, dt):
    """One implicit step of the stream power law along a given drainage."""
    rows, columns = np.divmod(np.arange(h.size), h.shape[1])
    length = cell * np.hypot(rows - rows[receiver], columns - columns[receiver]) + 1e-9
    power = np.clip(area**M_AREA - AREA_CRITICAL**M_AREA, 0, None)
    f = dt * K_STREAM * erodibility.ravel() * power / length
    z = h.ravel().copy()
    for cells in levels:
        target = z[receiver[cells]]
        z[cells] = np.where(z[cells] > target, (z[cells] + f[cells] * target) / (1 + f[cells]), z[cells])
    return np.minimum(h, z.reshape(h.shape) + THRESHOLD * dt)


# ---- slopes ----


def fail(h, scree, rock, cell):
    """Lets rock above its threshold slope fall; scree protects what it covers. Returns the new rock and what fell."""
    n, m = h.shape
    padded = np.pad(h + scree, 2, mode="edge")
    tangent, _, share = rock.at(h - 0.5 * cell)
    excess = np.zeros_like(h)
    for r, c in NEIGHBOURS + KNIGHTS:
        neighbour = padded[2 + r : 2 + r + n, 2 + c : 2 + c + m]
        excess = np.maximum(excess, h - neighbour - cell * np.hypot(r, c) * tangent)
    fallen = np.minimum(share * excess, 3.0 * cell) * np.exp(-scree / 0.7)
    return h - fallen, fallen


def spread(rock_top, scree, cell, rounds):
    """Moves scree down until it lies at its angle of repose."""
    n, m = scree.shape
    for _ in range(rounds):
        surface = rock_top + scree
        padded = np.pad(surface, 1, constant_values=1e9)
        excess = []
        for r, c in NEIGHBOURS:
            drop = surface - padded[1 + r : 1 + r + n, 1 + c : 1 + c + m] - REPOSE * cell * np.hypot(r, c)
            excess.append(np.clip(drop, 0, None))
        total = sum(excess)
        largest = np.maximum.reduce(excess)
        moved = np.minimum(scree, 0.5 * largest)
        with np.errstate(invalid="ignore", divide="ignore"):
            unit = np.where(total > 0, moved / total, 0)
        gain = np.zeros((n + 2, m + 2))
        for (r, c), e in zip(NEIGHBOURS, excess):
            gain[1 + r : 1 + r + n, 1 + c : 1 + c + m] += unit * e
        scree = scree - np.where(total > 0, moved, 0) + gain[1:-1, 1:-1]
    return scree


def creep(h, share, steepest):
    """Diffusion where the ground is flatter than `steepest` (per sample): rounds soil-covered edges, leaves cliffs."""
    padded = np.pad(h, 1, mode="edge")
    mean = 0.25 * (padded[:-2, 1:-1] + padded[2:, 1:-1] + padded[1:-1, :-2] + padded[1:-1, 2:])
    drop = np.maximum.reduce([np.abs(h - padded[1 + r : 1 + r + h.shape[0], 1 + c : 1 + c + h.shape[1]])
                              for r, c in NEIGHBOURS[::2]])
    return h + share * np.clip(1 - drop / steepest, 0, 1) * (mean - h)


# ---- the canyon ----


def positions(stride):
    """Map positions of the samples; row 0 is the north edge."""
    n = SIZE // stride
    y, x = np.meshgrid((n - 1 - np.arange(n)) * CELL * stride, np.arange(n) * CELL * stride, indexing="ij")
    return x, y


def plateau(x, y):
    """Gentle relief before the cutting: swells, the river's old valley and those of the streams that come in."""
    h = PLATEAU + 2.2 * fourier_noise(1, x, y, 260, 3) + 0.8 * fourier_noise(2, x, y, 70, 3)
    h += 0.12 * fourier_noise(3, x, y, 23, 3, 0.6)
    to_river = np.abs(y - river_y(x, 0.0))
    h += 0.022 * to_river - 7 * np.exp(-((to_river / 28) ** 2))
    for k, (ex, ey, _) in enumerate(INFLOWS):
        mouth = ex + 34 * np.sin(1.7 * k + 0.6)
        side = np.sign(ey - 256)
        along = np.clip((y - river_y(x, 0.0)) * side / 230, 0, 1)
        path = mouth + (ex - mouth) * along + 11 * np.sin(along * 7 + k)
        h -= 3.2 * np.exp(-(((x - path) / 15) ** 2)) * (side * (y - river_y(x, 0.0)) > 0)
    return h


def carve_river(h, x, y, progress, cell):
    """The main river's bed at its present level, and its mask."""
    centre = river_y(x, progress)
    slope = (river_y(x + 1, progress) - river_y(x - 1, progress)) / 2
    off = np.abs(y - centre) / np.sqrt(1 + slope**2)
    level = river_level(progress) + RIVER_SLOPE * (x.max() - x)
    bed = off < np.maximum(RIVER_HALF_WIDTH * (1 + 0.3 * np.sin(x / 37)), 1.1 * cell)
    return np.where(bed, np.minimum(h, level + 0.08 * off), h), bed


def evolve(h, scree, stride, first, last, rng, log):
    """Runs the steps of one grid, from progress `first` to `last`."""
    cell = CELL * stride
    x, y = positions(stride)
    rock = Rock(x, y)
    inflow = np.zeros_like(h)
    for ex, ey, area in INFLOWS:
        inflow[np.clip(h.shape[0] - 1 - int(ey / cell), 0, h.shape[0] - 1), int(ex / cell)] += area
    steps = STEPS[stride]
    dt = (last - first) * STEPS[2] / steps
    for step in range(steps):
        progress = first + (last - first) * (step + 1) / steps
        h, bed = carve_river(h, x, y, progress, cell)
        scree = np.where(bed, 0, scree)
        surface = h + scree
        if step % REROUTE == 0:
            receiver, levels = drainage(fill_pits(surface, bed), bed, cell, rng)
            area = accumulate(receiver, levels, (cell * cell + inflow).ravel())
        _, erodibility, _ = rock.at(surface)
        lowered = np.minimum(surface - incise(surface, erodibility, receiver, levels, area, cell, dt), 6.0)
        # streams take scree first, then rock
        from_scree = np.minimum(lowered, scree)
        scree, h = scree - from_scree, h - (lowered - from_scree)
        for _ in range(3 if stride == 2 else 2):
            h, fallen = fail(h, scree, rock, cell)
            scree = scree + SCREE_SHARE * fallen
        scree = spread(h, scree, cell, 4 if stride == 2 else 6)
        scree *= 1 - 0.012 * (area.reshape(h.shape) > 600) - 0.003  # washed away
        h = creep(h, CREEP[stride], 0.8 * cell)
        if step % 40 == 0:
            log(f"{cell:g} m cells, step {step}: {h.min():.0f} to {h.max():.0f} m, scree to {scree.max():.1f} m")
    return h, scree


def refine(h):
    """The grid at half the spacing: linear between samples, the last row and column continued."""
    for _ in range(2):
        h = np.vstack([h, 2 * h[-1:] - h[-2:-1]])
        fine = np.empty((2 * h.shape[0] - 2, h.shape[1]))
        fine[0::2], fine[1::2] = h[:-1], 0.5 * (h[:-1] + h[1:])
        h = fine.T
    return h


def canyon(log):
    rng = np.random.Generator(np.random.Philox(2026))
    x, y = positions(2)
    h, scree = evolve(plateau(x, y), np.zeros_like(x), 2, 0.0, 0.93, rng, log)
    # row 0 is the north edge and must keep its place: refine from the south-west corner
    h, scree = refine(h[::-1])[::-1], refine(scree[::-1])[::-1]
    h, scree = evolve(h, np.clip(scree, 0, None), 1, 0.93, 1.0, rng, log)
    x, y = positions(1)
    scree = spread(h, scree, CELL, 60)
    surface = blur(h + scree, 0.6)
    # blocks on the scree and a rough bed
    stony = np.clip(scree / 1.5, 0, 1)
    surface += 0.16 * stony * fourier_noise(71, x, y, 9, 2) + 0.05 * fourier_noise(72, x, y, 7, 2)
    return surface


# ---- files ----


def write_exr(path, h, note):
    """Scanline OpenEXR 2, one float channel Y, ZIP blocks of 16 lines (OpenEXR file layout, openexr.com)."""
    height, width = h.shape

    def attribute(name, kind, data):
        return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(data)) + data

    box = struct.pack("<4i", 0, 0, width - 1, height - 1)
    channel = b"Y\0" + struct.pack("<iB3xii", 2, 0, 1, 1) + b"\0"
    header = struct.pack("<ii", 20000630, 2)
    header += attribute("channels", "chlist", channel) + attribute("comments", "string", note)
    header += attribute("compression", "compression", b"\x03") + attribute("dataWindow", "box2i", box)
    header += attribute("displayWindow", "box2i", box) + attribute("lineOrder", "lineOrder", b"\0")
    header += attribute("pixelAspectRatio", "float", struct.pack("<f", 1))
    header += attribute("screenWindowCenter", "v2f", struct.pack("<2f", 0, 0))
    header += attribute("screenWindowWidth", "float", struct.pack("<f", 1)) + b"\0"
    chunks = []
    for row in range(0, height, 16):
        raw = np.frombuffer(h[row : row + 16].astype("<f4").tobytes(), np.uint8)
        split = np.concatenate([raw[0::2], raw[1::2]]).astype(np.int16)  # even bytes, then odd ones
        delta = np.concatenate([split[:1], (split[1:] - split[:-1] + 384) & 255]).astype(np.uint8)
        packed = zlib.compress(delta.tobytes(), 9)
        packed = packed if len(packed) < len(raw) else raw.tobytes()
        chunks.append(struct.pack("<ii", row, len(packed)) + packed)
    start = len(header) + 8 * len(chunks)
    offsets = np.cumsum([start] + [len(c) for c in chunks[:-1]]).astype("<u8")
    path.write_bytes(header + offsets.tobytes() + b"".join(chunks))


def main():
    path = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parent / "canyon.exr"
    h = np.round(canyon(lambda line: print(line, flush=True)) * 128) / 128  # 8 mm: the low bits are only noise
    write_exr(path, h.astype(np.float32), b"Elevations in metres, 1 m apart; made by make_canyon.py.")
    gy, gx = np.gradient(h, CELL)
    slope = np.degrees(np.arctan(np.hypot(gx, gy)))
    print(f"{path.name}: {h.min():.1f} to {h.max():.1f} m, {100 * (slope > 45).mean():.0f} % steeper than 45 degrees, "
          f"{100 * (slope > 60).mean():.0f} % than 60, {path.stat().st_size // 1024} KiB")


if __name__ == "__main__":
    main()
