#!/usr/bin/env python3
"""Holds data and documents against each other: schema, examples, reliefs, canyon, references. Standard library only."""
import ast
import json
import re
import struct
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SCHEMA = json.loads((ROOT / "data/schemas/strata.schema.json").read_text())
STRATA = sorted((ROOT / "data/strata").glob("*.json"))


def schema_of(part):
    return SCHEMA["$defs"][part["$ref"].rsplit("/", 1)[1]] if "$ref" in part else part


def complaints(value, part, place):
    """What the part of the schema has against the value: keys, words and bounds, as far as strata files need."""
    part = schema_of(part)
    found = []
    if part.get("type") == "object":
        found += [f"{place}: unknown key {key}" for key in value if key not in part["properties"]]
        for key, child in part["properties"].items():
            if key in value:
                found += complaints(value[key], child, f"{place}.{key}")
    elif part.get("type") == "array":
        if not part.get("minItems", 0) <= len(value) <= part.get("maxItems", 10**6):
            found.append(f"{place}: {len(value)} items")
        for i, item in enumerate(value):
            found += complaints(item, part["items"], f"{place}[{i}]")
    elif part.get("type") in ("number", "integer"):
        if not part.get("minimum", -1e300) <= value <= part.get("maximum", 1e300):
            found.append(f"{place}: {value} is out of bounds")
    elif "enum" in part and value not in part["enum"]:
        found.append(f"{place}: {value} is none of {part['enum']}")
    return found


def property_names(part, within=()):
    reference = part.get("$ref")
    if reference in within:  # Rules hold rules.
        return
    part, within = schema_of(part), (*within, reference) if reference else within
    for key, child in part.get("properties", {}).items():
        yield key
        yield from property_names(child, within)
    if "items" in part:
        yield from property_names(part["items"], within)


class Strata(unittest.TestCase):
    def test_examples_obey_the_schema(self):
        self.assertGreaterEqual(len(STRATA), 4)
        for path in STRATA:
            self.assertEqual(complaints(json.loads(path.read_text()), SCHEMA, path.name), [])

    def test_layers_name_materials_and_reliefs_exist(self):
        for path in STRATA:
            rock = json.loads(path.read_text())
            names = [material["name"] for material in rock["materials"]]
            for layer in rock.get("strata", {}).get("layers", []):
                self.assertIn(layer["material"], names, path.name)
            for material in rock["materials"]:
                self.assertTrue((ROOT / f"data/reliefs/{material['relief']['image']}.png").is_file(), path.name)

    def test_rocks_have_sources_and_a_small_picture_in_the_gallery(self):
        gallery = (ROOT / "docs/gallery.md").read_text()
        rocks = [path for path in STRATA if path.stem != "canyon"]
        self.assertGreaterEqual(len(rocks), 10)
        for path in rocks:
            for source in json.loads(path.read_text())["sources"]:
                self.assertIn(source, gallery, path.name)
            self.assertIn(f"(images/gallery/{path.stem}.png)", gallery)
            self.assertLess((ROOT / f"docs/images/gallery/{path.stem}.png").stat().st_size, 300 * 1024, path.name)

    def test_every_key_of_the_schema_is_documented(self):
        text = (ROOT / "docs/formats.md").read_text()
        self.assertEqual([key for key in property_names(SCHEMA) if f"`{key}`" not in text], [])

    def test_the_canyon_stands_in_the_layers_that_shaped_it(self):
        script = ast.parse((ROOT / "data/heightmaps/make_canyon.py").read_text())
        constants = {}
        for node in script.body:
            if isinstance(node, ast.Assign):
                try:
                    constants[ast.unparse(node.targets[0])] = ast.literal_eval(node.value)
                except ValueError:
                    pass  # computed: not one of those compared
        strata = json.loads((ROOT / "data/strata/canyon.json").read_text())["strata"]
        shaped = [(material, top) for material, top, *_ in constants["LAYERS"]]
        layers = [(layer["material"], layer.get("top", shaped[-1][1])) for layer in strata["layers"]]
        self.assertEqual(layers, shaped)
        self.assertEqual(
            (strata["dip_deg"], strata["dip_direction_deg"]), constants["(DIP_DEG, DIP_DIRECTION_DEG)"]
        )


class Files(unittest.TestCase):
    def test_reliefs_are_small_16_bit_grey_pngs(self):
        for name in ("layered", "pitted", "cracked", "rough", "fluted", "pebbly"):
            data = (ROOT / f"data/reliefs/{name}.png").read_bytes()
            self.assertEqual(struct.unpack(">IIBB", data[16:26]), (512, 512, 16, 0), name)
            self.assertLess(len(data), 450 * 1024, name)

    def test_the_canyon_is_one_small_channel_of_floats(self):
        data = (ROOT / "data/heightmaps/canyon.exr").read_bytes()
        self.assertEqual(data[:4], struct.pack("<I", 20000630))
        self.assertIn(b"channels\0chlist\0" + struct.pack("<i", 19) + b"Y\0" + struct.pack("<i", 2), data)
        self.assertIn(struct.pack("<4i", 0, 0, 511, 511), data)
        self.assertLess(len(data), 900 * 1024)


class Documents(unittest.TestCase):
    def test_every_cited_key_is_in_the_references(self):
        known = set(re.findall(r"\*\*(\w+)\*\*", (ROOT / "docs/references.md").read_text()))
        cited = {}
        for folder in ("include", "lib", "apps"):
            for path in (ROOT / folder).rglob("*.[hc]*"):
                for key in re.findall(r"@cite (\w+)", path.read_text()):
                    cited.setdefault(key, path.relative_to(ROOT))
        self.assertEqual({key: str(path) for key, path in cited.items() if key not in known and key != "OGC"}, {})

    def test_links_between_documents_lead_somewhere(self):
        for path in [*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md")]:
            for target in re.findall(r"\]\(([^)#]+)[^)]*\)", path.read_text()):
                if not target.startswith("http"):
                    self.assertTrue((path.parent / target).exists(), f"{path.relative_to(ROOT)}: {target}")


if __name__ == "__main__":
    unittest.main()
