"""Holds the stages to the order of docs/architecture.md: who may include whom, and where third parties may appear."""
import pathlib
import re
import sys

MAY_INCLUDE = {
    "core": "", "implicit": "core", "terrain": "core implicit", "fracture": "core implicit", "mesh": "core implicit",
    "tiles": "core implicit fracture", "render": "core implicit mesh",
    "amplify": "core implicit terrain fracture tiles mesh render"}
THIRD_PARTIES = {  # what its headers look like; the stages that may use it, each in one source file
    "GLM": (r"glm/", "core implicit terrain fracture tiles mesh render amplify"), "TBB": (r"(oneapi/)?tbb/", "core"),
    "OpenImageIO": (r"OpenImageIO/", "core"), "nlohmann-json": (r"nlohmann/", "core"),
    "OpenVDB": (r"openvdb/", "implicit"), "libtiff": (r"tiff", "terrain"),
    "CGAL": (r"CGAL/", "fracture mesh"), "meshoptimizer": (r"meshoptimizer", "mesh"),
    "Embree": (r"embree3/", "render")}
SYSTEM = r"[a-z_]+$|sys/|(unistd|fcntl|pthread|immintrin)\.h$"


def violations(files):
    """Complaints about `files`, a dictionary from path to text."""
    found, used_by = [], {}
    for path, text in files.items():
        public, stage = path.startswith("include/"), path.split("/")[-2]
        near = {stage, *MAY_INCLUDE[stage].split()}
        if path.endswith("CMakeLists.txt"):
            deps = re.search(r"outcrop_module\([^)]*?\bDEPS\s+([a-z\s]+)", text)
            found += [f"{path}: DEPS names {dep}" for dep in (deps[1].split() if deps else []) if dep not in near]
            continue
        deps = re.search(r"\bDEPS\s+([a-z\s]+)", files.get(f"lib/{stage}/CMakeLists.txt", ""))
        near &= {stage, *(deps[1].split() if deps else [])}
        ours = re.findall(r'#include "outcrop/(\w+)/', text)
        found += [f"{path}: includes {name}" for name in ours if name not in near]
        for header in re.findall(r"#include <([^>]+)>", text):
            party = next((name for name, (look, _) in THIRD_PARTIES.items() if re.match(look, header)), None)
            if not party:
                found += [] if re.match(SYSTEM, header) else [f"{path}: includes <{header}>, of no known third party"]
            elif party != "GLM":
                used_by.setdefault((party, stage), set()).add(path)
                found += [f"{path}: {party} in a public header"] if public else []
                found += [] if stage in THIRD_PARTIES[party][1].split() else [f"{path}: {party} is not for {stage}"]
    several = [f"{party} in {sorted(paths)}" for (party, _), paths in used_by.items() if len(paths) > 1]
    return found + several


root = pathlib.Path(__file__).resolve().parent.parent
patterns = ("include/outcrop/*/*.h", "lib/*/*.h", "lib/*/*.cpp", "lib/*/CMakeLists.txt")
paths = [path for pattern in patterns for path in root.glob(pattern)]
sources = {str(path.relative_to(root)): path.read_text(encoding="utf-8") for path in paths}
planted = {"include/outcrop/core/x.h": '#include "outcrop/mesh/x.h"\n#include <tbb/x.h>',
           "lib/core/x.cpp": "#include <tbb/x.h>",
           "lib/tiles/CMakeLists.txt": "outcrop_module(tiles DEPS core mesh)", "lib/terrain/x.cpp": "#include <zlib.h>",
           "lib/mesh/x.cpp": "#include <embree3/rtcore.h>"}
caught = violations(planted)
assert len(caught) == 6, f"six violations were planted, these were caught: {caught}"
sys.exit("\n".join(violations(sources)) or (0 if len(sources) > 50 else "no sources found"))
