#!/usr/bin/env python3
"""Outcrops against made rock: derives joint sets from trace maps, makes rock from them, cuts it level, and compares.

    bench/outcrops.py --data TABLES --bin build/bench/bin --strata bench/outcrops --pictures docs/images > table.md

For each map: joint sets by azimuth, spacing along scan lines, trace lengths, P21; a strata file with these numbers; a box
of rock made from it by outcrop_cut; the same measures, by the same code, of its level cuts. Needs numpy.

How a map is read
- Traces are polylines; a trace's azimuth is that of the line between its ends, its length that of the line.
- Sets: peaks of the azimuths' density, weighted by length (Gaussian kernel of 8 degrees on the half circle). A peak
  counts when it stands out by a quarter of the highest; a trace belongs to the nearest peak within 22.5 degrees, others
  are random. Where the map comes in sets (Pontrelli), these are taken.
- Spacing: distances between neighbouring traces of a set on scan lines across it, one every 1/41 of the width, inside
  the mapped area.
- P21: length of traces over mapped area.
"""
import argparse
import gzip
import json
import math
import struct
import subprocess
import sys
from pathlib import Path

import numpy as np

LINES = 41           # scan lines a set
LEVELS = 5           # cuts of a box
SAMPLES = 50         # across a box
COVERED_SHARE = 0.2
REACH_DEG = 22.5
KERNEL_DEG = 8.0
HEAD = """| map | set | spacing, m: map | made | CV: map | made | length, median: map | made | mean: map | made | P21: map | made |
|---|---|---|---|---|---|---|---|---|---|---|---|"""


# --- reading -------------------------------------------------------------------------------------------------------
def read_bytes(path):
    return gzip.open(path).read() if path.suffix == ".gz" else path.read_bytes()


def geojson_lines(path):
    """Every line or ring of a GeoJSON file, as arrays of x, y."""
    lines = []
    for feature in json.loads(read_bytes(path))["features"]:
        geometry = feature["geometry"]
        parts = geometry["coordinates"]
        if geometry["type"] in ("LineString",):
            parts = [parts]
        elif geometry["type"] == "MultiPolygon":
            parts = [ring for polygon in parts for ring in polygon]
        lines += [np.array(part, float)[:, :2] for part in parts]
    return lines


def shapefile_lines(path):
    """Every part of the polylines or polygons of a shapefile (ESRI 1998, types 3, 5, 13, 15, 23, 25)."""
    data = read_bytes(path)
    lines, at = [], 100
    while at + 8 <= len(data):
        size = 2 * struct.unpack(">i", data[at + 4:at + 8])[0]
        record = data[at + 8:at + 8 + size]
        at += 8 + size
        if struct.unpack("<i", record[:4])[0] % 10 not in (3, 5):
            continue
        part_count, point_count = struct.unpack("<2i", record[36:44])
        starts = list(struct.unpack(f"<{part_count}i", record[44:44 + 4 * part_count])) + [point_count]
        first = 44 + 4 * part_count
        points = np.frombuffer(record[first:first + 16 * point_count], "<f8").reshape(-1, 2)
        lines += [points[a:b].copy() for a, b in zip(starts, starts[1:])]
    return lines


# --- measuring -----------------------------------------------------------------------------------------------------
def azimuth_deg(line):
    d = line[-1] - line[0]
    return math.degrees(math.atan2(d[0], d[1])) % 180.0


def length(line):
    return float(np.hypot(*np.diff(line, axis=0).T).sum())


def turned(a, b):
    """Angle between two azimuths of lines, degrees, in [0, 90]."""
    d = np.abs(a - b) % 180.0
    return np.minimum(d, 180.0 - d)


def peaks(azimuths, weights):
    grid = np.arange(180.0)
    density = np.array([(weights * np.exp(-0.5 * (turned(azimuths, g) / KERNEL_DEG) ** 2)).sum() for g in grid])
    found = []
    for i in range(180):
        if density[i] < density[i - 1] or density[i] <= density[(i + 1) % 180]:
            continue
        low = density[i]  # the deepest saddle on the way to something higher, on the better side
        saddles = []
        for step in (1, -1):
            low, j = density[i], i
            for _ in range(180):
                j = (j + step) % 180
                low = min(low, density[j])
                if density[j] > density[i]:
                    break
            saddles.append(low)
        if density[i] - max(saddles) >= 0.25 * density.max() or density[i] == density.max():
            found.append(float(i))
    return sorted(found, key=lambda g: -density[int(g)])


def classify(lines):
    azimuths = np.array([azimuth_deg(line) for line in lines])
    weights = np.array([length(line) for line in lines])
    centres = np.array(peaks(azimuths, weights))
    gaps = turned(azimuths[:, None], centres[None, :])
    nearest = gaps.argmin(axis=1)
    return np.where(gaps.min(axis=1) <= REACH_DEG, nearest, -1)


def mean_azimuth(azimuths, weights):
    double = np.exp(2j * np.radians(azimuths))
    sum_ = (weights * double).sum()
    resultant = abs(sum_) / weights.sum()
    scatter = math.degrees(math.sqrt(-2.0 * math.log(max(resultant, 1e-9))) / 2.0)
    return math.degrees(np.angle(sum_)) / 2.0 % 180.0, scatter


def crossings(lines, origin, direction):
    """Places along a line where polylines cross it."""
    normal = np.array([-direction[1], direction[0]])
    places = []
    for line in lines:
        d = line - origin
        s, t = d @ normal, d @ direction
        for i in np.nonzero((s[:-1] < 0) != (s[1:] < 0))[0]:
            places.append(t[i] + (t[i + 1] - t[i]) * s[i] / (s[i] - s[i + 1]))
    return np.sort(np.array(places))


def spacings(lines, rings, azimuth):
    """Distances between traces on scan lines across a set, inside the area."""
    along = np.array([math.sin(math.radians(azimuth)), math.cos(math.radians(azimuth))])
    across = np.array([along[1], -along[0]])
    points = np.concatenate(rings)
    lo, hi = (points @ along).min(), (points @ along).max()
    result = []
    for i in range(LINES):
        origin = (lo + (hi - lo) * (i + 0.5) / LINES) * along
        borders = crossings(rings, origin, across)
        places = crossings(lines, origin, across)
        for a, b in zip(borders[::2], borders[1::2]):
            inside = places[(places > a) & (places < b)]
            result += list(np.diff(inside))
    return np.array(result)


def ring_area(ring):
    """Positive or negative by the sense in which the ring runs: holes run against their outline."""
    x, y = (ring - ring[0]).T
    return 0.5 * float((x * np.roll(y, -1) - y * np.roll(x, -1)).sum())


class Map:
    """Traces with their sets, and the rings around what was mapped."""

    def __init__(self, name, lines, sets, rings):
        self.name, self.rings = name, rings
        keep = [i for i, line in enumerate(lines) if len(line) > 1 and length(line) > 0.0]
        self.lines = [lines[i] for i in keep]
        self.sets = np.array([sets[i] for i in keep])
        self.lengths = np.array([length(line) for line in self.lines])
        self.azimuths = np.array([azimuth_deg(line) for line in self.lines])
        self.area = abs(sum(ring_area(r) for r in rings))

    def set_name(self, s):
        return f"{self.measure(s)['azimuth']:03.0f}" if s >= 0 else "random"

    def p21(self, s=None):
        chosen = self.lengths if s is None else self.lengths[self.sets == s]
        return float(chosen.sum()) / self.area

    def measure(self, s):
        chosen = self.sets == s
        azimuth, scatter = mean_azimuth(self.azimuths[chosen], self.lengths[chosen])
        gaps = spacings([line for line, c in zip(self.lines, chosen) if c], self.rings, azimuth)
        return {"azimuth": azimuth, "scatter": scatter, "n": int(chosen.sum()), "p21": self.p21(s),
                "spacing": float(gaps.mean()) if len(gaps) else math.nan,
                "cv": float(gaps.std() / gaps.mean()) if len(gaps) else math.nan,
                "mean": float(self.lengths[chosen].mean()), "median": float(np.median(self.lengths[chosen])),
                "p95": float(np.quantile(self.lengths[chosen], 0.95)), "longest": float(self.lengths[chosen].max())}


def read_maps(data):
    maps = []
    for name, traces, area in (("KB11", "KB11/KB11_traces.geojson.gz", "KB11/KB11_area.geojson"),
                               ("OG1", "OG1/og1_traces.geojson.gz", "OG1/og1_area.geojson"),
                               ("KL5", "KL5/kl5_traces.geojson.gz", "KL5/kl5_area.geojson")):
        lines = geojson_lines(data / traces)
        maps.append(Map(name, lines, classify(lines), geojson_lines(data / area)))
    folder = data / "cava_pontrelli"
    lines, sets = [], []
    for s, letter in enumerate("abc"):
        more = shapefile_lines(folder / f"Set_{letter}.shp.gz")
        lines += more
        sets += [s] * len(more)
    maps.append(Map("Pontrelli", lines, sets, shapefile_lines(folder / "Interpretation_boundary.shp")))
    return maps


# --- from a map to joint sets -----------------------------------------------------------------------------------------
def number(value):
    return round(float(value), 4)


def derive(outcrop):
    """The material of an outcrop. Its joints are taken as upright, so that P32 is the map's P21 (random ones lie in all
    directions: 4 / pi of it); the radii's power law has an exponent one above that of the traces' lengths (Hill's
    estimator above the median), from a quarter of their median on. Joints along the ground, which no map shows, are
    assumed. covered_share keeps small joints from growing beyond small blocks; 0.2 was
    found on KB11."""
    spacing = float(np.mean([outcrop.measure(s)["spacing"] for s in set(outcrop.sets) if s >= 0]))
    side = round(12.0 * spacing, 1)
    sets = []
    for s in sorted(set(outcrop.sets), reverse=True):
        m = outcrop.measure(s)
        tail = outcrop.lengths[(outcrop.sets == s) & (outcrop.lengths >= m["median"])]
        exponent = 1.0 / np.log(tail / m["median"]).mean() + 1.0
        sets.append({"name": outcrop.set_name(s), "frame": "tile", "dip_deg": 90.0,
                     "dip_direction_deg": number((m["azimuth"] + 90.0) % 360.0),
                     "kappa": number(math.radians(m["scatter"]) ** -2) if s >= 0 else 1.0,
                     "p32": number(m["p21"] * (1.0 if s >= 0 else 4.0 / math.pi)),
                     "radius": [number(0.25 * m["median"]), number(0.5 * side)], "radius_law": "power_law",
                     "radius_exponent": number(min(exponent, 4.0))})
    sets.append({"name": "level", "frame": "tile", "dip_deg": 0.0, "dip_direction_deg": 0.0, "kappa": 100.0,
                 "p32": number(0.5 / spacing), "radius": [number(spacing), number(0.5 * side)],
                 "radius_law": "power_law", "radius_exponent": 2.0})
    return {"name": outcrop.name, "tile_side": side, "sample_spacing": number(side / SAMPLES), "min_block_samples": 1,
            "joint_sets": sets, "covered_share": COVERED_SHARE, "least_thickness": number(0.005 * side),
            "least_angle_deg": 10.0}


def write_strata(path, outcrop, material):
    text = {"version": 1, "description": f"Joint sets of the trace map {outcrop.name}, by bench/outcrops.py.",
            "materials": [material]}
    path.write_text(json.dumps(text, indent=2) + "\n")


# --- making it, and cutting it ------------------------------------------------------------------------------------------
class Made:
    """Level cuts of a box of rock: a map each."""

    def __init__(self, program, strata, material, seed):
        out = subprocess.run([str(program), str(strata), str(seed), str(LEVELS)], check=True, capture_output=True,
                             text=True).stdout
        side = material["tile_side"]
        square = np.array([[0, 0], [side, 0], [side, side], [0, side], [0, 0]], float)
        self.cuts, rows = [], []
        for line in out.splitlines() + ["# level end"]:
            if line.startswith("# blocks"):
                self.head = line[2:]
            elif line.startswith("# level"):
                if rows:
                    lines = [np.array([[a, b], [c, d]], float) for a, b, c, d, _ in rows]
                    names = [name for *_, name in rows]
                    self.cuts.append(Map("cut", lines, names, [square]))
                rows = []
            elif not line.startswith(("x0", "#")):
                values = line.split(",")
                rows.append([float(v) for v in values[:4]] + [values[4]])

    def measure(self, name):
        """Means over the cuts."""
        found = [cut.measure(name) for cut in self.cuts if (cut.sets == name).sum() > 2]
        return {key: float(np.nanmean([m[key] for m in found])) for key in found[0]}

    def p21(self):
        return float(np.mean([cut.p21() for cut in self.cuts]))

    def lengths(self):
        return np.concatenate([cut.lengths for cut in self.cuts])


# --- the table --------------------------------------------------------------------------------------------------------
def pair(a, b, digits=2):
    return f"{a:.{digits}f} | {b:.{digits}f}"


def rows_of(outcrop, made):
    rows = []
    for s in sorted(set(outcrop.sets), reverse=True):
        name = outcrop.set_name(s)
        a, b = outcrop.measure(s), made.measure(name)
        rows.append(f"| {outcrop.name} | {name if s < 0 else name + '°'} | {pair(a['spacing'], b['spacing'])} | "
                    f"{pair(a['cv'], b['cv'])} | {pair(a['median'], b['median'])} | {pair(a['mean'], b['mean'])} | "
                    f"{pair(a['p21'], b['p21'])} |")
    lengths = made.lengths()
    rows.append(f"| {outcrop.name} | **all** | | | | | {pair(np.median(outcrop.lengths), np.median(lengths))} | "
                f"{pair(outcrop.lengths.mean(), lengths.mean())} | {pair(outcrop.p21(), made.p21())} |")
    return rows


def picture(outcrop, made, side):
    """Map and level cut beside each other, windows of the same size, as SVG."""
    colours = ["#0072b2", "#d55e00", "#009e73", "#cc79a7"]
    name_of = {s: outcrop.set_name(s) for s in sorted(set(outcrop.sets))}
    size, names = 420, [name for s, name in name_of.items() if s >= 0]
    middle = np.concatenate(outcrop.rings).mean(axis=0) - 0.5 * side
    panels = ((outcrop.lines, [name_of[s] for s in outcrop.sets], middle, f"{outcrop.name}, map"),
              (made.cuts[0].lines, made.cuts[0].sets, np.zeros(2), "made rock, level cut"))
    body = ""
    for k, (lines, sets, corner, title) in enumerate(panels):
        body += (f'<text x="{k * (size + 30)}" y="16">{title}, {side:.0f} m</text>'
                 f'<svg x="{k * (size + 30)}" y="24" width="{size}" height="{size}" viewBox="0 0 {side} {side}">')
        for line, name in zip(lines, sets):
            p = line - corner
            if (p.max(axis=0) < 0).any() or (p.min(axis=0) > side).any():
                continue
            points = " ".join(f"{x:.2f},{side - y:.2f}" for x, y in p)
            colour = colours[names.index(name) % 4] if name in names else "#777"
            body += f'<polyline points="{points}" fill="none" stroke="{colour}" stroke-width="{side / 400:.3f}"/>'
        body += f'<rect width="{side}" height="{side}" fill="none" stroke="#222" stroke-width="{side / 200:.3f}"/></svg>'
    width, height = 2 * size + 30, size + 30
    return (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" '
            f'height="{height}" font-family="Helvetica, Arial, DejaVu Sans" font-size="14">'
            f'<rect width="{width}" height="{height}" fill="#fff"/>{body}</svg>\n')


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--data", type=Path, required=True, help="folder of the trace maps")
    parser.add_argument("--bin", type=Path, required=True, help="folder of outcrop_cut")
    parser.add_argument("--strata", type=Path, required=True, help="folder for the strata files")
    parser.add_argument("--pictures", type=Path, help="folder for map and cut beside each other, SVG")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", nargs="*", help="names of maps")
    options = parser.parse_args()
    options.strata.mkdir(parents=True, exist_ok=True)
    print(HEAD)
    for outcrop in read_maps(options.data):
        if options.only and outcrop.name not in options.only:
            continue
        strata = options.strata / f"{outcrop.name.lower()}.json"
        material = derive(outcrop)
        write_strata(strata, outcrop, material)
        made = Made(options.bin / "outcrop_cut", strata, material, options.seed)
        print("\n".join(rows_of(outcrop, made)), flush=True)
        if options.pictures:
            name = f"outcrop_{outcrop.name.lower()}.svg"
            (options.pictures / name).write_text(picture(outcrop, made, material["tile_side"]))
        print(outcrop.name, f"{outcrop.area:.0f} m2 mapped, {len(outcrop.lines)} traces; box of",
              f"{material['tile_side']} m, {LEVELS} cuts, {len(made.lengths())} traces;", made.head, file=sys.stderr)


if __name__ == "__main__":
    main()
