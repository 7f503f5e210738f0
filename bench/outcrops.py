#!/usr/bin/env python3
"""Outcrops against made rock: derives joint sets from trace maps, makes rock from them, cuts it level, and compares.

    bench/outcrops.py --data ../shared/data/tables --bin build/bench/bin --out docs/outcrops.md

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
import tempfile
from pathlib import Path

import numpy as np

LINES = 41
REACH_DEG = 22.5
KERNEL_DEG = 8.0


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
def derive(outcrop):
    """Joint sets of a material. The joints are taken as upright, so that P32 is the map's P21; a power law of radii has
    an exponent one above that of its traces' lengths; joints along the ground, which no map shows, are assumed."""
    sets, spacing_sum = [], []
    for s in sorted(set(outcrop.sets)):
        m = outcrop.measure(s)
        lengths = outcrop.lengths[outcrop.sets == s]
        tail = lengths[lengths >= m["median"]]
        exponent = 1.0 / np.log(tail / m["median"]).mean() + 1.0  # Hill's estimator, and the cut
        joint_set = {"name": f"{m['azimuth']:03.0f}" if s >= 0 else "random",
                     "dip_deg": 90.0, "dip_direction_deg": round((m["azimuth"] + 90.0) % 360.0, 1),
                     "kappa": round(math.radians(m["scatter"]) ** -2, 1) if s >= 0 else 1.0,
                     "p32": round(m["p21"] * (1.0 if s >= 0 else 4.0 / math.pi), 4),
                     "radius_law": "power_law", "radius_exponent": round(min(exponent, 4.0), 2)}
        sets.append((s, joint_set))
        if s >= 0:
            spacing_sum.append(m["spacing"])
    spacing = float(np.mean(spacing_sum))
    side = round(12.0 * spacing, 1)
    for s, joint_set in sets:
        median = float(np.median(outcrop.lengths[outcrop.sets == s]))
        joint_set["radius"] = [round(0.25 * median, 3), round(0.5 * side, 2)]
    level = {"name": "level", "dip_deg": 0.0, "dip_direction_deg": 0.0, "kappa": 100.0, "p32": round(0.5 / spacing, 4),
             "radius_law": "power_law", "radius_exponent": 2.0, "radius": [round(spacing, 2), round(0.5 * side, 2)]}
    return [joint_set for _, joint_set in sets if joint_set["p32"] > 0.0] + [level], side
