"""Others' opinion of solid meshes: CGAL's exact test of intersections, and trimesh, without which the rest is skipped
(exit 77).

Usage: judge_test.py AMPLIFY COUNT_INTERSECTIONS
"""
import json
import os
import subprocess
import sys
import tempfile

import images

AMPLIFY, COUNT_INTERSECTIONS = sys.argv[1:]

with tempfile.TemporaryDirectory(prefix="outcrop-") as folder:
    images.exr(os.path.join(folder, "cliff.exr"), 48, 48, {"Y": images.cliff()})
    with open(os.path.join(folder, "small.json"), "w") as file:
        json.dump({"materials": [{"tile_side": 16, "sample_spacing": 0.9}]}, file)

    def solid(name, *arguments):
        subprocess.run([AMPLIFY, "cliff.exr", "--strata", "small.json", "--solid", "--quiet", "-o", name, *arguments],
                       cwd=folder, check=True)
        found = subprocess.run([COUNT_INTERSECTIONS, name], cwd=folder, capture_output=True, text=True)
        assert found.stdout == "0\n" and found.returncode == 0, "%s intersects itself: %s" % (name, found)

    # Floats are coarse 9 km up: triangles of the walls would turn over if they were rounded there once more.
    solid("high.ply", "--height-offset", "9000", "--resolution", "0.05", "--region", "15", "15", "27", "27")
    solid("solid.ply", "--resolution", "0.25")
    try:
        import trimesh
    except ImportError:
        print("skipped: python3 has no trimesh")
        sys.exit(77)
    mesh = trimesh.load(os.path.join(folder, "solid.ply"), process=False)
    assert len(mesh.faces) > 10_000, len(mesh.faces)
    assert mesh.is_watertight, "open edges"
    assert mesh.is_winding_consistent, "neighbours disagree about outside"
    assert mesh.volume > 0, "inside out"
    print("%d faces, watertight, %g cubic metres" % (len(mesh.faces), mesh.volume))
