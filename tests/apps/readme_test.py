"""Runs the commands of the README's "Use it" as they stand, only with smaller pictures.

Usage: readme_test.py FOLDER_OF_PROGRAMS
"""
import os
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
block = re.search(r"## Use it\n```sh\n(.*?)```", (ROOT / "README.md").read_text(), re.S).group(1)
commands = [shlex.split(line, comments=True) for line in block.replace("\\\n", " ").splitlines() if line.strip()]
assert len(commands) >= 3, commands
with tempfile.TemporaryDirectory(prefix="outcrop-") as folder:
    for name in ("data", "examples"):
        os.symlink(ROOT / name, os.path.join(folder, name))
    os.makedirs(os.path.join(folder, "build", "release"))
    os.symlink(os.path.abspath(sys.argv[1]), os.path.join(folder, "build", "release", "bin"))
    for command in commands:
        if command[0].endswith("amplify"):
            command += ["--size", "160", "90"]
        subprocess.run(command, cwd=folder, check=True)
    for name in ("canyon_rock.ply", "canyon_rock.png", "cliff.obj", "cliff.png", "cliff.json", "scene.stl"):
        assert os.path.getsize(os.path.join(folder, name)) > 1000, name
