"""Asks trimesh, and manifold3d where it is installed, whether our closed meshes are solids.

usage: judge.py PROGRAM   (outcrop_judge_meshes, which writes them). Exit 77: trimesh is not installed, nothing was judged.
"""
import pathlib
import subprocess
import sys
import tempfile

try:
    import numpy
    import trimesh
except ImportError as missing:
    print(f"skipped: no Python module {missing.name} (pip install trimesh manifold3d)")
    sys.exit(77)
try:
    import manifold3d
except ImportError:
    manifold3d = None


def faults(path):
    mesh = trimesh.load(path, process=path.suffix == ".stl")
    found = [name for name in ("is_watertight", "is_winding_consistent", "is_volume") if not getattr(mesh, name)]
    if not mesh.volume > 0:
        found.append("volume > 0")
    if manifold3d:
        solid = manifold3d.Manifold(manifold3d.Mesh(numpy.asarray(mesh.vertices, numpy.float32),
                                                    numpy.asarray(mesh.faces, numpy.uint32)))
        if solid.status() != manifold3d.Error.NoError or solid.num_tri() != len(mesh.faces):
            found.append(f"manifold3d: {solid.status()}")
    return found


def main():
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([sys.argv[1], folder], check=True)
        paths = sorted(pathlib.Path(folder).iterdir())
        wrong = {path.name: faults(path) for path in paths}
    for name, found in wrong.items():
        print(name, "is not: " + ", ".join(found) if found else "is a solid")
    return 1 if not paths or any(wrong.values()) else 0


sys.exit(main())
