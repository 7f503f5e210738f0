#!/usr/bin/env python3
"""Races the polygonizer against OpenVDB and, where cargo is, fidget: one model, one thread, CPU time of the same run.

Usage: race.py BUILD_FOLDER [--quick]   (--quick: without fidget)

Prints a Markdown table, and leaves what it holds in BUILD_FOLDER/race.json, for bars.py. The model is OUTCROP_BENCH_MODEL's, else one made up. fidget is fetched from crates.io and
built into BUILD_FOLDER/fidget; its finest mesh takes a minute.
"""
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from statistics import median

from run_benchmarks import ROOT, compiler, count_text, header, machine, output_of, row

FIDGET = ROOT / "bench/fidget"
DEPTHS = {6: 3, 7: 1, 8: 1}  # of fidget's octree, with how often each is run: all vary by some percent
OURS = "Outcrop"


def lines_of(*command):
    text = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True).stdout
    return [json.loads(line) for line in text.splitlines()]


def built_fidget(build):
    """The program, or None with a line that says why."""
    if not shutil.which("cargo"):
        print("fidget    not raced: there is no cargo")
        return None
    target = build / "fidget"
    done = subprocess.run(["cargo", "build", "--quiet", "--release", "--locked", "--target-dir", target], cwd=FIDGET)
    if done.returncode != 0:
        print("fidget    not raced: cargo could not build it")
        return None
    version = re.search(r'name = "fidget"\nversion = "(.*)"', (FIDGET / "Cargo.lock").read_text())[1]
    print(f"fidget    {version}, JIT, {output_of('rustc', '--version')}")
    return target / "release/fidget-race"


def run_fidget(fidget, race, folder):
    expression, mesh = folder / "model.txt", folder / "mesh.obj"
    subprocess.run([race, "--write-expression", expression], check=True)
    for depth, repetitions in DEPTHS.items():
        runs = [lines_of(fidget, expression, str(depth), mesh)[0]["seconds"] for _ in range(repetitions)]
        yield {"program": "fidget", "cell": 25.6 / 2**depth, "seconds": [median(s) for s in zip(*runs)],
               **lines_of(race, "--check", mesh)[0]}


def main():
    quick = "--quick" in sys.argv[2:]
    if len(sys.argv) != 2 + quick:
        sys.exit(__doc__.strip())
    build = Path(sys.argv[1]).resolve()
    race = build / "bin/outcrop_race"
    print(f"\nmachine   {machine()}\ncompiler  {compiler(build)}\n"
          f"commit    {output_of('git', 'describe', '--always', '--dirty=, with changes')}")
    version, *results = lines_of(race)
    model = Path(os.environ.get("OUTCROP_BENCH_MODEL", "made up")).name
    print(f"model     {model}\nOpenVDB   {version['openvdb']}")
    fidget = None if quick else built_fidget(build)
    if fidget:
        with tempfile.TemporaryDirectory() as folder:
            results += run_fidget(fidget, race, Path(folder))

    (build / "race.json").write_text(json.dumps(results))
    header("cells", "program", "CPU time", "its stages", "times " + OURS, "triangles", "open edges",
           "edges used twice in one direction", "vertices with several fans")
    for cell in sorted({r["cell"] for r in results}, reverse=True):
        found = [r for r in results if r["cell"] == cell]
        ours = next(r["seconds"][0] for r in found if r["program"] == OURS)
        for r in found:
            total, *stages = r["seconds"]
            row(f"{100 * cell:g} cm", r["program"], f"{total:.3g} s", " + ".join(f"{s:.3g}" for s in stages),
                f"{total / ours:.3g}", count_text(r["triangles"]), str(r["open_edges"]), str(r["nonmanifold_edges"]),
                str(r["nonmanifold_vertices"]))


if __name__ == "__main__":
    main()
