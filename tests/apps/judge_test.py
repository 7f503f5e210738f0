"""Someone else's opinion of a solid mesh: trimesh, where it is installed, else the test is skipped (exit 77).

Usage: judge_test.py AMPLIFY
"""
import json
import os
import subprocess
import sys
import tempfile

import images

try:
    import trimesh
except ImportError:
    print("skipped: python3 has no trimesh")
    sys.exit(77)

with tempfile.TemporaryDirectory(prefix="outcrop-") as folder:
    images.exr(os.path.join(folder, "cliff.exr"), 48, 48, {"Y": images.cliff()})
    with open(os.path.join(folder, "small.json"), "w") as file:
        json.dump({"materials": [{"tile_side": 16, "sample_spacing": 0.9}]}, file)
    subprocess.run([sys.argv[1], "cliff.exr", "--strata", "small.json", "--resolution", "0.25", "--solid", "--quiet", "-o",
                    "solid.ply"], cwd=folder, check=True)
    mesh = trimesh.load(os.path.join(folder, "solid.ply"), process=False)
    assert len(mesh.faces) > 10_000, len(mesh.faces)
    assert mesh.is_watertight, "open edges"
    assert mesh.is_winding_consistent, "neighbours disagree about outside"
    assert mesh.volume > 0, "inside out"
    print("%d faces, watertight, %g cubic metres" % (len(mesh.faces), mesh.volume))
