"""Installs the build, then builds and runs the embedding example as a project outside that finds the package.

usage: install_test.py CMAKE BUILD_FOLDER EXAMPLE_SOURCE CXX_COMPILER CXX_FLAGS
"""
import os
import subprocess
import sys
import tempfile

cmake, build, example, compiler, flags = sys.argv[1:]
here = os.path.dirname(os.path.abspath(__file__))


def run(*command, **options):
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, **options)
    if done.returncode != 0:
        sys.exit(f"{' '.join(command)}\n{done.stdout}")
    return done.stdout


with tempfile.TemporaryDirectory() as scratch:
    prefix = os.path.join(scratch, "prefix")
    outside = os.path.join(scratch, "outside")
    run(cmake, "--install", build, "--prefix", prefix)
    for wanted in ("include/outcrop/core/box.h", "share/outcrop/reliefs", "share/outcrop/strata"):
        assert os.path.exists(os.path.join(prefix, wanted)), wanted + " is not installed"
    for folder, _, files in os.walk(prefix):
        for name in files:
            if name.endswith(".cmake"):
                with open(os.path.join(folder, name), encoding="utf-8") as file:
                    assert build not in file.read(), f"{name} points into the build folder"
    run(cmake, "-S", here, "-B", outside, "-G", "Ninja", f"-DCMAKE_PREFIX_PATH={prefix}", f"-DOUTSIDE_SOURCE={example}",
        f"-DCMAKE_CXX_COMPILER={compiler}", f"-DCMAKE_CXX_FLAGS={flags}")
    run(cmake, "--build", outside)
    print(run(os.path.join(outside, "outside")), end="")
    print(run(os.path.join(prefix, "bin", "amplify"), "--version"), end="")
