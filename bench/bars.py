#!/usr/bin/env python3
"""Prints what the polygonizer is asked to reach, and what it reached.

Usage: bars.py BUILD_FOLDER [--quick]   after run_benchmarks.py and race.py on the same folder

A Markdown table: each figure beside its bar and beside a baseline that was measured in the same run. Figures are those of
benchmarks.json and race.json in BUILD_FOLDER, and of runs of amplify here, interleaved with their baselines: one thread and
two, one canyon and four, a cliff alone and in a square kilometre of gentle ground, and a square kilometre of the Alps where
OUTCROP_BENCH_DEM (default: ../shared/data/dem/alps_alr_5m/alps_alr_5m_f32.tif) is there. --quick: each once. Figures of
a build for AVX2 are read from AVX2_BUILD_FOLDER/benchmarks.json where OUTCROP_BENCH_AVX2 names such a folder.
"""
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from statistics import median

from run_benchmarks import ROOT, amplified, header, machine, output_of, row, seconds_text

PAIRS = 3  # Of interleaved runs; the median ratio is shown.
EQUAL_ERROR = 1.05  # Times the error of uniform cells that still counts as equal.
BUSY = 1.1  # Times its processor time: who waits longer had no CPU to himself, and two threads no second one.
CANYON = ("--strata", "data/strata/canyon.json", "--resolution", "0.5", "--tolerance", "0")
KILOMETRE = ("--region", "255744", "379093", "256744", "380093", "--resolution", "0.1", "--tolerance", "0.03", "--solid")
DEM = Path(os.environ.get("OUTCROP_BENCH_DEM", ROOT / "../shared/data/dem/alps_alr_5m/alps_alr_5m_f32.tif"))


def bar(what, goal, figure, reached, baseline="", ratio=None, cpu=None):
    """One row; `reached` is None where nothing was measured, with the reason as the figure."""
    verdict = "not measured" if reached is None else "reached" if reached else "**missed**"
    row(what, goal, figure, verdict, baseline, f"{ratio:.3g}" if ratio is not None else "",
        seconds_text(cpu) if cpu is not None else "")


def named(results, prefix):
    """The first benchmark whose name begins so, or None."""
    return next((found for name, found in results.items() if name.startswith(prefix)), None)


def value_bars(results, which, goals):
    for relief, goal in zip(("smooth", "relief"), goals):
        warp = int(relief == "relief")
        brick = named(results, f"narrowed_brick/warp:{warp}")
        block = named(results, f"whole_block/planes:20/warp:{warp}/gradients:0")
        what = f"value in a 10 cm brick at the surface, {relief}, {which}"
        if not brick or not block:
            bar(what, f"≤ {goal} ns", "no such build", None)
            continue
        figure = 1e9 * brick["s_point"]
        bar(what, f"≤ {goal} ns", f"{figure:.3g} ns", figure <= goal, "the block that is not narrowed",
            brick["s_point"] / block["s_point"], brick["cpu"])


def field_bars(results):
    widest = "AVX-512" if "avx512f" in Path("/proc/cpuinfo").read_text() else "this machine's widest"
    value_bars(results, widest, (4, 20))
    avx2 = Path(os.environ.get("OUTCROP_BENCH_AVX2", "-"), "benchmarks.json")
    value_bars(json.loads(avx2.read_text()) if avx2.exists() else {}, "AVX2", (8, 40))
    for relief, warp in (("smooth", 0), ("relief", 1)):
        one = named(results, f"random_value/warp:{warp}")
        block = named(results, f"whole_block/planes:20/warp:{warp}/gradients:0")
        if not one:
            bar(f"one value at a random point, one call, {relief}", "≤ 150 ns", "no OUTCROP_BENCH_MODEL", None)
        elif block:
            bar(f"one value at a random point, one call, {relief}", "≤ 150 ns", f"{1e9 * one['cpu']:.3g} ns",
                one["cpu"] <= 150e-9, "a value of a whole block, in a batch", one["cpu"] / block["s_point"], one["cpu"])


def tile_bars(results):
    tiles = [found["cpu"] for name, found in results.items() if name.startswith("tile/")]
    samples, small, large = (named(results, name) for name in ("samples", "growth/1", "growth/70"))
    if tiles and samples:
        bar("a tile of 14 500 samples, the slowest type", "≤ 0.15 s", seconds_text(max(tiles)), max(tiles) <= 0.15,
            "its samples alone", max(tiles) / samples["cpu"], max(tiles))
    if small and large:
        growth = large["time/sample"] / small["time/sample"]
        bar("10⁶ samples; time a sample, over that of a tile", "≤ 12 s; 1", seconds_text(large["cpu"]),
            large["cpu"] <= 12.0, "14 500 samples, a sample", growth, large["cpu"])


def mesh_bars(results):
    uniform, adaptive = (named(results, f"mesh_tile/{cells}/warp:1/threads:1") for cells in ("uniform", "adaptive"))
    ball = named(results, "ball/sheet/512/1")
    if uniform and ball:
        bar("a 20 m tile, 10 cm cells, relief, normals", "≤ 0.6 s", seconds_text(uniform["cpu"]), uniform["cpu"] <= 0.6,
            "a ball, a triangle", ball["triangles/s"] / uniform["triangles/s"], uniform["cpu"])
        bar("triangles a second, the same", "≥ 3 M", f"{uniform['triangles/s'] / 1e6:.3g} M",
            uniform["triangles/s"] >= 3e6, "a ball's", uniform["triangles/s"] / ball["triangles/s"], uniform["cpu"])
    if uniform and adaptive:
        ratio = uniform["triangles/s"] / adaptive["triangles/s"]
        bar("adaptive cells, time a triangle", "≤ 1.5 times", f"{ratio:.3g} times", ratio <= 1.5, "uniform cells", ratio,
            adaptive["cpu"])


def race_bars(race):
    ours = next((r["seconds"][0] for r in race if r["program"] == "Outcrop" and abs(r["cell"] - 0.1) < 1e-3), None)
    for program, goal in (("fidget", 100), ("OpenVDB", 2)):
        what = f"{program} over Outcrop, smooth, 10 cm"
        theirs = next((r["seconds"][0] for r in race if r["program"] == program and abs(r["cell"] - 0.1) < 1e-3), None)
        if ours is None or theirs is None:
            bar(what, f"≥ {goal}", "not raced", None)
        else:
            bar(what, f"≥ {goal}", f"{theirs / ours:.3g}", theirs / ours >= goal, "Outcrop", theirs / ours, ours)


def adaptivity_bar(results):
    equal = [found for name, found in results.items()
             if name.startswith("adaptivity/") and found["error_rms"] <= EQUAL_ERROR * found["uniform_error_rms"]]
    if equal:
        best = max(equal, key=lambda found: found["fewer"])
        error = best["error_rms"] / best["uniform_error_rms"]
        bar(f"fewer triangles than uniform cells, at {error:.3g} times the r.m.s. error", "≥ 8 times",
            f"{best['fewer']:.3g} times", best["fewer"] >= 8, "uniform cells", best["fewer"], best["cpu"])
    else:
        bar("fewer triangles than uniform cells at the same r.m.s. error", "≥ 8 times", "none", False)


def pairs(count, first, second):
    """Runs both in turn. @return: what they gave, as two lists."""
    made = [(first(), second()) for _ in range(count)]
    return [a for a, _ in made], [b for _, b in made]


def amplify_bars(build, folder, count):
    mesh = ("-o", folder / "mesh.ply")

    def run(*arguments):
        return amplified(build, folder, *arguments, *mesh)

    canyon, large, cliff = ROOT / "data/heightmaps/canyon.exr", folder / "large.exr", folder / "cliff.exr"
    for script, path in (("make_large_canyon.py", large), ("make_lone_cliff.py", cliff)):
        subprocess.run([sys.executable, ROOT / "bench" / script, path], check=True)

    one, two = pairs(count, lambda: run(canyon, *CANYON, "--threads", "1"), lambda: run(canyon, *CANYON, "--threads", "2"))
    speedup = median(a["seconds"]["meshing"] / b["seconds"]["meshing"] for (a, _), (b, _) in zip(one, two))
    waited = median(report["seconds"]["total"] / cpu for report, cpu in one)
    what = "one thread over two, by the clock, meshing the canyon"
    if waited > BUSY:
        bar(what, "≥ 1.7", f"busy machine: one thread took {waited:.2g} times its processor time", None)
    else:
        bar(what, "≥ 1.7", f"{speedup:.3g}", speedup >= 1.7, "two threads", speedup, median(cpu for _, cpu in two))

    small, four = pairs(count, lambda: run(canyon, *CANYON, "--region", "0", "0", "511", "511")[1],
                        lambda: run(large, *CANYON, "--region", "0", "0", "1023", "1023")[1])
    ratio = median(b / a for a, b in zip(small, four)) / (1023 / 511) ** 2 * 4
    bar("4 times the area of the same rock", "≤ 4.4 times the time", f"{ratio:.3g} times", ratio <= 4.4,
        "the canyon once", ratio, median(four))

    smooth = ("--resolution", "0.25", "--tolerance", "0.025")
    alone, around = pairs(count, lambda: run(cliff, *smooth, "--region", "463", "463", "559", "559")[1],
                          lambda: run(cliff, *smooth, "--region", "0", "0", "1023", "1023")[1])
    ground = median(b - a for a, b in zip(alone, around))
    bar("a square kilometre of gentle ground around a cliff", "next to nothing", f"{seconds_text(ground)} more",
        ground <= 0.5 * median(alone), "the cliff alone, in 96 m x 96 m", median(around) / median(alone), median(around))

    what, goal = "1 km² of 5 m input, rock over 45°, 0.1 m", "≤ 5 min, ≤ 4 GiB, closed"
    if not DEM.exists():
        bar(what, goal, "no elevation model", None)
        return
    strata = folder / "s45.json"
    strata.write_text('{"placement": {"slope_deg": 45}}')
    report, cpu = run(DEM, "--strata", strata, *KILOMETRE)
    seconds, memory, closed = report["seconds"]["total"], report["peak_memory"], report["mesh"]["closed"]
    canyon_report, canyon_cpu = run(canyon, *CANYON)
    a_triangle = (cpu / report["mesh"]["triangles"]) / (canyon_cpu / canyon_report["mesh"]["triangles"])
    bar(what, goal, f"{seconds:.0f} s, {memory / 2**30:.2f} GiB, {'closed' if closed else 'open'}",
        seconds <= 300 and memory <= 4 * 2**30 and closed, "the canyon, a triangle", a_triangle, cpu)
    total = sum(report["seconds"][stage] for stage in report["seconds"] if stage != "total")
    shares = ", ".join(f"{stage} {value / total:.0%}" for stage, value in report["seconds"].items()
                       if stage != "total" and value > 0.005 * total)
    print(f"\nOf that square kilometre's {seconds:.0f} s: {shares}.")


def main():
    quick = "--quick" in sys.argv[2:]
    if len(sys.argv) != 2 + quick:
        sys.exit(__doc__.strip())
    build = Path(sys.argv[1]).resolve()
    results, race = ({}, [])
    if (build / "benchmarks.json").exists():
        results = json.loads((build / "benchmarks.json").read_text())
    if (build / "race.json").exists():
        race = json.loads((build / "race.json").read_text())
    print(f"\nmachine   {machine()}\ncommit    {output_of('git', 'describe', '--always', '--dirty=, with changes')}")
    header("what", "bar", "figure", "", "baseline, in the same run", "ratio to it", "CPU time")
    field_bars(results)
    tile_bars(results)
    mesh_bars(results)
    race_bars(race)
    adaptivity_bar(results)
    with tempfile.TemporaryDirectory() as temporary:
        amplify_bars(build, Path(temporary), 1 if quick else PAIRS)


if __name__ == "__main__":
    main()
