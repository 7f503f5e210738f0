#!/usr/bin/env python3
"""Makes the relief images: tileable 16-bit grey PNGs that the gradient warp carves into the faces of blocks.

White (65535) is the untouched surface, black the deepest point; v runs to the image's top. Every image repeats in
u and v, has most of its surface near white, and its neighbouring pixels differ by less than MAX_STEP of full scale,
so that a relief's slope stays bounded (amplitude * MAX_STEP * SIZE / period).

    layered   beds of varying thickness, each broken into chunks by its own upright joints, with open partings
    pitted    weathering pits of many sizes, overlapping, with honeycombs between (tafoni)
    cracked   three generations of cracks, the younger ending at the older; few are open; plates differ in height
    rough     a broken surface: conchoidal shells, hackle ribs that radiate from their origins, grain
    fluted    runnels that join and split on their way down (rillenkarren), with stepped floors
    pebbly    rounded pebbles of many sizes that stand out of a worn matrix, some fallen out (conglomerate)

Usage: make_reliefs.py [FOLDER]     (default: the folder of this file; same bytes every time)
Needs Python 3.9 with numpy 1.20 or newer.
"""
import struct
import sys
import zlib
from pathlib import Path

import numpy as np

SIZE = 512  # pixels a side
MAX_STEP = 0.055  # of full scale, between neighbouring pixels
LEVELS = 4096  # grey levels written: finer ones would be 30 micrometres at an amplitude of 12 cm

V, U = np.meshgrid(1 - (np.arange(SIZE) + 0.5) / SIZE, (np.arange(SIZE) + 0.5) / SIZE, indexing="ij")


# ---- periodic building blocks ----


def noise(rng, low, high, slope=2.0, stretch_u=1.0, stretch_v=1.0):
    """Periodic noise of unit deviation: frequencies low to high (cycles an image), amplitude as f^(-slope/2)."""
    f = np.fft.fftfreq(SIZE, 1 / SIZE)
    fr = np.hypot(f[None, :] * stretch_u, f[:, None] * stretch_v)
    amplitude = np.where((fr >= low) & (fr <= high), np.maximum(fr, 1e-9) ** (-slope / 2), 0.0)
    field = np.fft.ifft2(np.fft.fft2(rng.standard_normal((SIZE, SIZE))) * amplitude).real
    return (field - field.mean()) / field.std()


def blur(h, sigma):
    """Periodic Gaussian blur, sigma in pixels."""
    f = np.fft.fftfreq(SIZE)
    g = np.exp(-2 * (np.pi * sigma) ** 2 * (f[None, :] ** 2 + f[:, None] ** 2))
    return np.fft.ifft2(np.fft.fft2(h) * g).real


def sample(h, u, v):
    """h at wrapped positions, bilinear."""
    x = (u * SIZE - 0.5) % SIZE
    y = ((1 - v) * SIZE - 0.5) % SIZE
    x0, y0 = np.floor(x).astype(int), np.floor(y).astype(int)
    fx, fy = x - x0, y - y0
    x0, y0 = x0 % SIZE, y0 % SIZE
    x1, y1 = (x0 + 1) % SIZE, (y0 + 1) % SIZE
    top = h[y0, x0] * (1 - fx) + h[y0, x1] * fx
    return top * (1 - fy) + (h[y1, x0] * (1 - fx) + h[y1, x1] * fx) * fy


def wrap(d):
    return d - np.round(d)


def scatter(rng, count, candidates=12):
    """Evenly scattered points of the unit torus: each is the farthest of some candidates (Mitchell 1991)."""
    points = [rng.random(2)]
    for _ in range(count - 1):
        c = rng.random((candidates, 2))
        d = wrap(c[:, None] - np.array(points)[None])
        points.append(c[np.argmax((d**2).sum(-1).min(1))])
    return np.array(points)


def smoothstep(lo, hi, x):
    t = np.clip((x - lo) / (hi - lo), 0, 1)
    return t * t * (3 - 2 * t)


def limit_step(h, step):
    """The largest surface below h whose neighbouring pixels differ by at most `step`: walls become ramps.

    The ramps are smoothed, or they would carry every notch of a ragged rim down to the foot.
    """
    low, last = h, None
    while last is None or not np.array_equal(low, last):
        last = low
        for dy, dx in ((0, 1), (1, 0), (1, 1), (1, -1)):
            rise = step * np.hypot(dx, dy)
            for sign in (-1, 1):
                low = np.minimum(low, np.roll(low, (sign * dy, sign * dx), (0, 1)) + rise)
    ramp = smoothstep(0.0, 0.06, blur(h - low, 2.0))
    return low + ramp * (blur(low, 2.2) - low)


def finish(h, mean, high=97.0):
    """Scales h to 0..1 with its `high` percentile at white, bends it to the wanted mean and bounds its steps."""
    lo, hi = np.percentile(h, [0.05, high])
    t = np.clip((h - lo) / (hi - lo), 0, None)
    t = np.where(t > 0.75, 1 - 0.25 * np.exp(-(t - 0.75) / 0.25), t)  # a soft shoulder instead of clipped plateaus
    lo, hi = 0.15, 4.0
    for _ in range(40):  # the exponent that gives the mean
        mid = 0.5 * (lo + hi)
        lo, hi = (mid, hi) if (t**mid).mean() > mean else (lo, mid)
    t = limit_step(t**lo, 0.9 * MAX_STEP)
    return np.clip(blur(t, 0.7), 0, 1)


# ---- the six ----


def layered(rng):
    # Beds: thicknesses are log-normal, as measured in sections; every bed has its own hardness and joints.
    thickness = np.exp(rng.normal(0, 0.62, 26))
    tops = np.cumsum(thickness) / thickness.sum()
    bottoms = np.concatenate([[0.0], tops[:-1]])
    ragged = noise(rng, 2, 70, 2.4, stretch_u=1.0, stretch_v=2.0)
    v = (V + 0.006 * noise(rng, 1, 5, 2, 1, 1) + 0.0016 * ragged) % 1.0
    bed = np.searchsorted(tops, v, side="right") % len(tops)
    hard = rng.beta(1.6, 0.9, len(tops))
    h = np.zeros((SIZE, SIZE))
    edge = np.ones((SIZE, SIZE))
    wobble = noise(rng, 3, 40, 2.2, 1.5, 0.7)
    for k in range(len(tops)):
        inside = bed == k
        size = tops[k] - bottoms[k]
        # upright joints, spaced in proportion to the bed's thickness; chunks between them stand out or have fallen
        count = max(3, int(1 / (size * rng.uniform(1.6, 4.5))))
        joints = np.sort(((np.arange(count) + rng.uniform(-0.42, 0.42, count)) / count + rng.random()) % 1.0)
        u = (U[inside] + 0.0045 * wobble[inside] + rng.uniform(-0.25, 0.25) * (v[inside] - bottoms[k])) % 1.0
        chunk = np.searchsorted(joints, u) % count
        heights = rng.normal(0, 0.10, count) - np.where(rng.random(count) < 0.16, rng.uniform(0.15, 0.4, count), 0)
        left = np.minimum.reduce([np.abs(wrap(u - joints[(chunk + s) % count])) for s in (-1, 0)])
        across = np.minimum(v[inside] - bottoms[k], tops[k] - v[inside])
        soft = 1 - hard[k]
        nose = smoothstep(0, 0.35, across / size)  # beds are rounded towards their partings
        h[inside] = -0.42 * soft + heights[chunk] * (0.4 + 0.6 * hard[k]) + 0.10 * nose
        open_joint = np.where(rng.random(count) < 0.5, 0.16, 0.05)[chunk]
        h[inside] -= open_joint * (1 - smoothstep(0.0, 0.006, left)) * hard[k]
        parting = rng.uniform(0.08, 0.45)
        edge[inside] = 1 - parting * (1 - smoothstep(0.0015, 0.008, across))
    h = h + (edge - 1) * (0.75 + 0.25 * np.tanh(noise(rng, 2, 12, 1.5)))
    laminae = noise(rng, 25, 120, 1.2, stretch_u=6.0, stretch_v=1.0)
    h += 0.035 * laminae * (1.2 - hard[bed]) + 0.02 * noise(rng, 20, 110, 1.6) + 0.03 * noise(rng, 2, 20, 2.5)
    return finish(blur(h, 0.8), 0.72)


def pitted(rng):
    du, dv = 0.012 * noise(rng, 3, 24, 2.2), 0.012 * noise(rng, 3, 24, 2.2)
    u, v = U + du, V + dv
    where = noise(rng, 1, 4, 2.0)  # pits come in swarms
    h = np.zeros((SIZE, SIZE))
    # pit radii follow a power law (most are small); floors are bowls, rims are sharp, roofs overhang a little less
    radii = 0.012 * (1 - rng.random(260) * (1 - (0.012 / 0.115) ** 1.5)) ** (-1 / 1.5)
    for r in np.sort(radii)[::-1]:
        for _ in range(30):
            c = rng.random(2)
            i, j = int((1 - c[1]) * SIZE) % SIZE, int(c[0] * SIZE)
            if where[i, j] + rng.normal(0, 0.6) > 0.25:
                break
        stretch = rng.uniform(1.0, 1.6)
        angle = rng.normal(0.0, 0.35)
        x, y = wrap(u - c[0]), wrap(v - c[1])
        x, y = x * np.cos(angle) + y * np.sin(angle), -x * np.sin(angle) + y * np.cos(angle)
        d = np.hypot(x, y * stretch) / r
        y_rel = np.clip(y / r, -1, 1)
        bowl = np.clip(1 - d**2.6, 0, None) ** 0.6 * (1 + 0.18 * y_rel)  # deepest below the roof
        depth = 0.95 * (r / 0.115) ** 0.62 * rng.uniform(0.55, 1.0)
        h = np.minimum(h, -depth * bowl + 0.35 * h * (d < 1))
        h += 0.03 * (r / 0.1) * np.exp(-(((d - 1.12) / 0.12) ** 2))  # case-hardened rim
    # honeycomb: cells with thin walls, where the noise allows
    cells = scatter(rng, 420)
    f1 = np.full((SIZE, SIZE), 9.0)
    f2 = f1.copy()
    for c in cells:
        d = np.hypot(wrap(u - c[0]), wrap(v - c[1]))
        f2 = np.minimum(f2, np.maximum(f1, d))
        f1 = np.minimum(f1, d)
    comb = smoothstep(0.002, 0.022, f2 - f1)
    h -= 0.30 * comb * smoothstep(0.2, 1.3, -where + 0.5 * noise(rng, 3, 9, 2))
    h += 0.05 * noise(rng, 4, 30, 2.0) + 0.022 * noise(rng, 40, 150, 0.6)
    return finish(blur(h, 0.8), 0.76)


def cracked(rng):
    du = 0.010 * noise(rng, 3, 20, 2.2) + 0.0022 * noise(rng, 20, 110, 1.4)
    dv = 0.010 * noise(rng, 3, 20, 2.2) + 0.0022 * noise(rng, 20, 110, 1.4)
    u, v = U + du, V + dv
    parent = np.zeros((SIZE, SIZE), int)
    parent_of = lambda p: parent[int((1 - p[1]) * SIZE) % SIZE, int(p[0] * SIZE) % SIZE]
    h = 0.10 * noise(rng, 1, 6, 2.6)
    fade = noise(rng, 2, 10, 1.8)
    for level, (count, open_share, width, depth, step) in enumerate(
        [(9, 0.40, 0.0085, 0.75, 0.10), (34, 0.25, 0.0055, 0.50, 0.075), (130, 0.10, 0.0036, 0.34, 0.04)]
    ):
        points = scatter(rng, count)
        owners = [parent_of(p) for p in points]
        best = np.full((SIZE, SIZE), 9.0)
        second = best.copy()
        own = np.zeros((SIZE, SIZE), int)
        other = own.copy()
        stretch = 1.0 if level else 1.5
        for k, p in enumerate(points):
            # only the points of the same older plate compete: younger cracks end at older ones
            d = np.where(parent == owners[k], np.hypot(wrap(u - p[0]), stretch * wrap(v - p[1])), 9.0)
            closer = d < best
            second = np.where(closer, best, np.minimum(second, d))
            other = np.where(closer, own, np.where(d == second, k, other))
            own = np.where(closer, k, own)
            best = np.minimum(best, d)
        gap = np.where(second < 5, second - best, 9.0) / 2  # about the distance to the crack
        pair = (np.minimum(own, other) * 7919 + np.maximum(own, other) * 104729 + level * 15485863) % 65521 / 65521
        strength = np.where(pair < open_share, 1.0, 0.16 + 0.3 * ((pair * 37) % 1))
        young = 0.35 + 0.65 * smoothstep(-1.1, 0.9, fade + 0.5 * (pair - 0.5))
        strength *= young if level else 0.8 + 0.2 * np.tanh(fade)
        w = width * (0.45 + 0.75 * strength)
        tilt = rng.normal(0, 1, (count, 2)) * step * 2.2
        height = rng.normal(0, step, count)
        x, y = wrap(u - points[own][..., 0]), wrap(v - points[own][..., 1])
        h += height[own] + tilt[own][..., 0] * x + tilt[own][..., 1] * y
        h -= 0.10 * (0.6**level) * np.exp(-gap / (0.018 * 0.7**level))  # plates are worn towards their edges
        h -= depth * strength * np.clip(1 - gap / w, 0, 1) ** 0.8
        parent = parent * 1009 + own + 1
    h += 0.018 * noise(rng, 30, 140, 0.8) + 0.025 * noise(rng, 6, 40, 2.0)
    return finish(blur(h, 0.7), 0.77, 98.5)


def rough(rng):
    warp_u, warp_v = 0.008 * noise(rng, 2, 14, 3.0), 0.008 * noise(rng, 2, 14, 3.0)
    h = np.zeros((SIZE, SIZE))
    # Shells: each is a scoop that opened from its own origin; the deepest at a point is what is left, with sharp
    # ridges between. Sizes over three octaves; stretched a little across the direction of breaking.
    for count, weight, tilt in [(34, 0.75, 1.0), (150, 0.5, 0.9), (800, 0.2, 0.7)]:
        u, v = U + warp_u * np.sqrt(20 / count), V + warp_v * np.sqrt(20 / count)
        points = scatter(rng, count, 5)
        spacing = 1 / np.sqrt(count)
        surface = np.full((SIZE, SIZE), 9.0)
        x_of = np.zeros((SIZE, SIZE))
        y_of = np.zeros((SIZE, SIZE))
        origin = np.zeros((SIZE, SIZE), int)
        for k, p in enumerate(points):
            angle = rng.normal(0.6, 0.9)
            x, y = wrap(u - p[0]) / spacing, wrap(v - p[1]) / spacing
            x, y = x * np.cos(angle) + y * np.sin(angle), -x * np.sin(angle) + y * np.cos(angle)
            slope = np.clip(rng.normal(0.6, 0.35), -0.1, 1.2) * tilt
            scoop = rng.uniform(0.5, 1.1) * (x * x + 1.6 * y * y) + slope * x + rng.normal(0, 0.11)
            deeper = scoop < surface
            surface = np.where(deeper, scoop, surface)
            x_of, y_of = np.where(deeper, x, x_of), np.where(deeper, y, y_of)
            origin = np.where(deeper, k, origin)
        h += weight * 0.5 * surface
        # hackle: ribs along the rays from a shell's origin, stronger away from it; faint arrest lines across
        angle = np.arctan2(y_of, x_of + 0.9)
        phase = rng.random(count)[origin]
        ribs = 1 - np.abs(np.sin(angle * 11 + 6.283 * phase + 0.9 * noise(rng, 3, 24, 2.0)))
        far = smoothstep(0.2, 1.0, np.hypot(x_of + 0.9, y_of))
        strong = (rng.random(count) ** 1.5)[origin]
        arrest = np.sin(np.hypot(x_of + 0.9, y_of) * 19 + 6.283 * phase)
        h += weight * far * strong * (0.075 * ribs + 0.02 * arrest)
    # grain: crystals that broke through or around, slightly stretched
    grains = scatter(rng, 1500, 2)
    f1 = np.full((SIZE, SIZE), 9.0)
    value = np.zeros((SIZE, SIZE))
    for p, level in zip(grains, rng.normal(0, 1, len(grains))):
        # a window around the grain is enough: no grain is nearer than its neighbours some 0.026 away
        cols = np.arange(int((p[0] - 0.075) * SIZE), int((p[0] + 0.075) * SIZE)) % SIZE
        rows = np.arange(int((1 - p[1] - 0.075) * SIZE), int((1 - p[1] + 0.075) * SIZE)) % SIZE
        window = np.ix_(rows, cols)
        x, y = U[window] + 0.4 * warp_u[window] - p[0], V[window] + 0.4 * warp_v[window] - p[1]
        d = np.hypot(wrap(x), 1.35 * wrap(y))
        near = d < f1[window]
        f1[window] = np.where(near, d, f1[window])
        value[window] = np.where(near, level - 30 * d, value[window])
    h += 0.020 * value + 0.018 * noise(rng, 50, 160, 0.7, 1.0, 1.3)
    return finish(blur(h, 0.75), 0.72, 98.0)


def fluted(rng):
    v_axis = V[:, :1]
    h = np.full((SIZE, SIZE), 9.0)
    floor_of = np.zeros((SIZE, SIZE))
    u = U + 0.006 * noise(rng, 2, 12, 2.4) + 0.0016 * noise(rng, 12, 60, 1.6)
    count = 19
    starts = np.sort((np.arange(count) + rng.uniform(-0.38, 0.38, count)) / count)

    def wander(scale, octaves):
        """A smooth periodic function of v."""
        w = np.zeros_like(v_axis)
        for k in range(1, octaves + 1):
            w += rng.normal(0, scale / k**1.2) * np.sin(2 * np.pi * (k * v_axis + rng.random()))
        return w

    for k in range(count):
        centre = starts[k] + wander(0.009, 5)
        width = rng.uniform(0.7, 1.35) / count
        level = rng.normal(-0.1, 0.16) + wander(0.17, 3)  # runnels deepen, fade out and are taken over by neighbours
        x = wrap(u - centre) / width
        scoop = level + 1.15 * np.minimum(x * x, 0.35 + 0.55 * np.abs(x))
        floor_of = np.where(scoop < h, k, floor_of)
        h = np.minimum(h, scoop)
    # small flutes on the flanks, and steps down the floors: water falls from pool to pool
    fine = np.full((SIZE, SIZE), 9.0)
    for _ in range(58):
        centre = rng.random() + wander(0.010, 5)
        x = wrap(u - centre) * 58 / 0.95
        fine = np.minimum(fine, rng.normal(0, 0.35) + wander(0.45, 4) + 0.9 * x * x)
    h = np.minimum(h, 0.62) + 0.085 * np.clip(fine, -1, 1.2)
    phase = rng.random(count)[floor_of.astype(int)] + 0.10 * noise(rng, 2, 14, 2.0, 1.0, 1.0)
    pools = (7 * V + 3 * phase) % 1.0
    h -= 0.13 * smoothstep(0.45, -0.1, h) * (1 - pools) ** 2 * smoothstep(0, 0.12, pools)
    h += 0.035 * noise(rng, 3, 40, 2.0, 1.6, 0.8) + 0.014 * noise(rng, 50, 150, 0.7)
    return finish(blur(h, 0.8), 0.68, 98.0)


def pebbly(rng):
    h = 0.30 + 0.05 * noise(rng, 3, 12, 2.0) + 0.02 * noise(rng, 30, 150, 0.8)
    taken = np.zeros((SIZE, SIZE), bool)
    # radii follow a power law; the largest find their places first, smaller ones fill the room between them
    radii = 0.008 * (1 - rng.random(2600) * (1 - (0.008 / 0.085) ** 1.6)) ** (-1 / 1.6)
    for r in np.sort(radii)[::-1]:
        c = rng.random(2)
        flat, lean, phase = rng.uniform(1.15, 1.8), rng.normal(0.0, 0.3), rng.uniform(-np.pi, np.pi)
        reach = np.arange(-int(1.4 * r * SIZE) - 1, int(1.4 * r * SIZE) + 2)
        window = np.ix_((int((1 - c[1]) * SIZE) + reach) % SIZE, (int(c[0] * SIZE) + reach) % SIZE)
        x, y = wrap(U[window] - c[0]), wrap(V[window] - c[1])
        x, y = x * np.cos(lean) + y * np.sin(lean), (-x * np.sin(lean) + y * np.cos(lean)) * flat
        d = np.hypot(x, y) * (1 + 0.07 * np.sin(3 * np.arctan2(y, x) + phase)) / r
        core = d < 1.02
        if taken[window][core].any():
            continue
        taken[window] |= core
        out = rng.uniform(0.35, 1.0) * min(1.0, 0.25 + r / 0.05)
        dome = np.clip(1 - d**2.4, 0, None) ** 0.55
        if rng.random() < 0.07:  # fallen out: its mould is left
            h[window] -= 0.4 * out * np.clip(1 - d**2, 0, None) ** 0.7
        else:
            worn = 0.05 * np.exp(-(((d - 1.06) / 0.08) ** 2))  # the matrix, along its rim
            h[window] += out * 0.62 * dome - worn
    return finish(blur(h, 0.7), 0.66)


# ---- files ----


def write_png(path, h):
    """16-bit grey PNG; each row takes the filter whose residuals are smallest (PNG specification, section 12.8)."""
    grey = np.rint(h * (LEVELS - 1)).astype(np.uint32) * 65535 // (LEVELS - 1)
    raw = np.ascontiguousarray(grey.astype(">u2")).view(np.uint8).reshape(SIZE, 2 * SIZE).astype(np.int16)
    up = np.vstack([np.zeros((1, 2 * SIZE), np.int16), raw[:-1]])
    left = np.hstack([np.zeros((SIZE, 2), np.int16), raw[:, :-2]])
    upleft = np.hstack([np.zeros((SIZE, 2), np.int16), up[:, :-2]])
    guess = left + up - upleft
    pa, pb, pc = np.abs(guess - left), np.abs(guess - up), np.abs(guess - upleft)
    paeth = np.where((pa <= pb) & (pa <= pc), left, np.where(pb <= pc, up, upleft))
    filters = [np.zeros_like(raw), left, up, (left + up) // 2, paeth]
    residuals = np.stack([(raw - f) & 255 for f in filters])
    cost = np.where(residuals < 128, residuals, 256 - residuals).sum(-1)
    best = cost.argmin(0)
    rows = b"".join(bytes([best[y]]) + residuals[best[y], y].astype(np.uint8).tobytes() for y in range(SIZE))

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", SIZE, SIZE, 16, 0, 0, 0, 0)
    path.write_bytes(
        b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b"")
    )


def main():
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parent
    for seed, make in enumerate([layered, pitted, cracked, rough, fluted, pebbly], start=1):
        h = make(np.random.Generator(np.random.Philox(seed)))
        step = max(np.abs(h - np.roll(h, 1, axis)).max() for axis in (0, 1))
        if step > 0.06 or not 0.6 <= h.mean() <= 0.85:
            raise SystemExit(f"{make.__name__}: step {step:.3f} or mean {h.mean():.3f} is out of bounds")
        path = folder / f"{make.__name__}.png"
        write_png(path, h)
        print(f"{path.name}: mean {h.mean():.2f}, step {step:.3f}, {path.stat().st_size // 1024} KiB")


if __name__ == "__main__":
    main()
