#!/usr/bin/env python3
"""Runs the benchmarks of a build and amplify from file to file, and prints a Markdown table of each.

Usage: run_benchmarks.py BUILD_FOLDER [--quick]

--quick: one repetition each, and no kilometre of canyon. What was measured is left in BUILD_FOLDER/benchmarks.json, for
bars.py.
"""
import json
import os
import platform
import re
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
REPETITIONS = 5  # of each benchmark; the median is shown
MIN_SECONDS = 0.05  # of each repetition


def output_of(*command):
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True).stdout.strip()


def machine():
    model = re.search(r"model name\s*: (.*)", Path("/proc/cpuinfo").read_text())
    return f"{model[1] if model else platform.machine()}, {os.cpu_count()} CPUs"


def compiler(build):
    found = re.search(r"^CMAKE_CXX_COMPILER:\w+=(.*)$", (build / "CMakeCache.txt").read_text(), re.M)
    return output_of(found[1], "--version").splitlines()[0]


def row(*cells):
    print("| " + " | ".join(cells) + " |", flush=True)


def header(*cells):
    print()
    row(*cells)
    row(*["---"] * len(cells))


def scaled(value, units):
    """Three digits with the largest unit that leaves a number of 1 or more."""
    for scale, unit in units:
        if value >= scale or (scale, unit) == units[-1]:
            return f"{value / scale:.3g} {unit}".strip()


def seconds_text(value):
    return scaled(value, [(1.0, "s"), (1e-3, "ms"), (1e-6, "µs"), (1e-9, "ns"), (1e-12, "ps")])


def count_text(value):
    return scaled(value, [(1e6, "M"), (1e3, "k"), (1.0, "")])


def counter_text(name, value):
    if name in ("s_point", "s_plane_point", "time/sample"):
        what = {"s_point": "point", "s_plane_point": "plane and point", "time/sample": "sample"}[name]
        return f"{seconds_text(value)} a {what}"
    if name in ("triangles/s", "items_per_second"):
        return f"{count_text(value)} {'triangles' if name == 'triangles/s' else 'rays'}/s"
    return f"{count_text(value)} {name.replace('_', ' ')}"


def run_program(program, repetitions):
    """Prints a row a benchmark. @return: by name, the processor time in seconds and its counters."""
    known = {"name", "run_name", "run_type", "aggregate_name", "aggregate_unit", "time_unit", "label", "family_index",
             "per_family_instance_index", "repetitions", "repetition_index", "threads", "iterations", "real_time", "cpu_time"}
    stage = program.name.removeprefix("outcrop_").removesuffix("_bench")
    done = subprocess.run(
        [program, f"--benchmark_min_time={MIN_SECONDS}", f"--benchmark_repetitions={repetitions}",
         "--benchmark_report_aggregates_only=true", "--benchmark_format=json"],
        stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, check=True)
    found = {}
    for result in json.loads(done.stdout)["benchmarks"]:
        if result.get("error_occurred"):
            row(stage, result["name"], "–", result["error_message"])
        elif result.get("aggregate_name", "median") == "median":
            unit = {"ns": 1e-9, "us": 1e-6, "ms": 1e-3, "s": 1.0}[result["time_unit"]]
            found[result["run_name"]] = {"cpu": result["cpu_time"] * unit,
                                         **{name: value for name, value in result.items() if name not in known}}
            counters = [counter_text(name, value) for name, value in result.items() if name not in known]
            if "real_time" in result["run_name"] and counters:
                counters[-1] += " by the clock"
            row(stage, result["run_name"].replace("/process_time", "").replace("/real_time", ""),
                seconds_text(result["cpu_time"] * unit), ", ".join([*filter(None, [result.get("label")]), *counters]))
    return found


def amplified(build, folder, *arguments):
    """The report of a run of amplify, and the processor time that it took."""
    report = folder / "report.json"
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([build / "bin/amplify", *arguments, "--report", report, "--quiet"], cwd=ROOT, check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return json.loads(report.read_text()), cpu


def run_amplify(build, folder, name, *arguments):
    found, cpu = amplified(build, folder, *arguments)
    stages = ", ".join(f"{stage} {value:.2f}" for stage, value in found["seconds"].items() if stage != "total" and value > 0)
    triangles = found["mesh"]["triangles"] if found.get("mesh") else 0
    row(name, f"{found['options']['resolution']:.3g} m", count_text(found["replicated_blocks"]),
        count_text(triangles) if triangles else "–", f"{cpu:.1f} s", f"{found['seconds']['total']:.1f} s", stages,
        f"{found['peak_memory'] / 1e6:.0f} MB")


def main():
    quick = "--quick" in sys.argv[2:]
    if len(sys.argv) != 2 + quick:
        sys.exit(__doc__.strip())
    build = Path(sys.argv[1]).resolve()
    print(f"\nmachine   {machine()}\ncompiler  {compiler(build)}\n"
          f"commit    {output_of('git', 'describe', '--always', '--dirty=, with changes')}")

    header("stage", "benchmark", "CPU time", "")
    benchmarks = {}
    for program in sorted((build / "bin").glob("outcrop_*_bench")):
        benchmarks |= run_program(program, 1 if quick else REPETITIONS)
    (build / "benchmarks.json").write_text(json.dumps(benchmarks))

    header("amplify", "cells", "blocks", "triangles", "CPU time", "time", "seconds by stage", "peak memory")
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        large = folder / "large.exr"
        subprocess.run([sys.executable, ROOT / "bench/make_large_canyon.py", large], check=True)
        mesh = ("-o", folder / "mesh.ply")
        picture = ("--preview", folder / "picture.png", "--size", "640", "360")
        strata = ("--strata", "data/strata/canyon.json")
        run_amplify(build, folder, "canyon: mesh", "data/heightmaps/canyon.exr", *strata, *mesh)
        if quick:
            return
        run_amplify(build, folder, "canyon: picture, 640 x 360", "data/heightmaps/canyon.exr", *strata, *picture)
        run_amplify(build, folder, "1024 x 1024, steepest part: mesh", large, *strata, *mesh)
        run_amplify(build, folder, "1024 x 1024, all of it: mesh", large, *strata, *mesh, "--region", "0", "0", "1023",
                    "1023", "--resolution", "0.5")


if __name__ == "__main__":
    main()
