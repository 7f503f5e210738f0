"""What the two programs promise to whoever calls them: exit codes, one line on stderr, whole files or none.

Usage: program_test.py AMPLIFY POLYGONIZE [unittest's arguments]. Only the standard library.
"""
import json
import os
import resource
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import time
import unittest

import images

AMPLIFY, POLYGONIZE = sys.argv[1], sys.argv[2]
SMALL = {"materials": [{"tile_side": 16, "sample_spacing": 0.9}]}


class ProgramTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="outcrop-")
        self.addCleanup(shutil.rmtree, self.folder)
        os.mkdir(self.path("out"))
        images.exr(self.path("cliff.exr"), 48, 48, {"Y": images.cliff()})
        self.write("small.json", json.dumps(SMALL))

    def path(self, *names):
        return os.path.join(self.folder, *names)

    def write(self, name, text):
        with open(self.path(name), "w" if isinstance(text, str) else "wb") as file:
            file.write(text)
        return self.path(name)

    def run_program(self, program, *arguments, **options):
        return subprocess.run([program, *arguments], cwd=self.folder, capture_output=True, text=True, timeout=120,
                              **options)

    def amplify(self, *arguments, **options):
        return self.run_program(AMPLIFY, *arguments, **options)

    def small(self, *arguments, **options):
        """A run that takes a second."""
        return self.amplify("cliff.exr", "--strata", "small.json", "--resolution", "0.5", *arguments, **options)

    def assert_refused(self, result, *words, code=2, program="amplify"):
        """Exit `code`, one line on stderr that names program and words, nothing on stdout, nothing written."""
        lines = result.stderr.splitlines()
        self.assertEqual(result.returncode, code, result.stderr)
        self.assertEqual(len(lines), 1, result.stderr)
        self.assertTrue(lines[0].startswith(program + ": "), lines[0])
        for word in words:
            self.assertIn(word, lines[0])
        self.assertEqual(result.stdout, "")
        self.assertEqual(os.listdir(self.path("out")), [])

    def assert_heightmap_refused(self, name, *words):
        result = self.amplify(name, "-o", "out/a.ply", "--preview", "out/a.png", "--report", "out/a.json")
        self.assert_refused(result, name, *words)

    def assert_strata_refused(self, text, *words):
        self.write("bad.json", text)
        result = self.amplify("cliff.exr", "--strata", "bad.json", "-o", "out/a.ply")
        self.assert_refused(result, "bad.json", *words)


class BadHeightmaps(ProgramTest):
    def test_missing_file(self):
        self.assert_heightmap_refused("gone.exr")

    def test_directory(self):
        os.mkdir(self.path("folder.exr"))
        self.assert_heightmap_refused("folder.exr", "folder")

    def test_empty_files(self):
        for name in ("empty.exr", "empty.tif", "empty.png", "N10E010.hgt"):
            self.write(name, "")
            self.assert_heightmap_refused(name)

    def test_truncated_files(self):
        images.tiff(self.path("cliff.tif"), 48, 48, images.cliff())
        images.png(self.path("cliff.png"), 48, 48, [int(1000 * h) for h in images.cliff()])
        for name in ("cliff.exr", "cliff.tif", "cliff.png"):
            with open(self.path(name), "rb") as file:
                data = file.read()
            for share in (0.02, 0.5, 0.9):
                with self.subTest(name=name, share=share):
                    self.write("cut-" + name, data[:int(share * len(data))])
                    self.assert_heightmap_refused("cut-" + name)

    def test_wrong_extension_and_foreign_content(self):
        self.write("text.exr", "these are no pixels")
        self.write("noise.tif", bytes(range(256)) * 40)
        self.write("notes.txt", "neither are these")
        for name in ("text.exr", "noise.tif", "notes.txt", "small.json"):
            with self.subTest(name=name):
                self.assert_heightmap_refused(name)

    def test_images_without_area(self):
        images.exr(self.path("none.exr"), 0, 0, {"Y": []})
        images.png(self.path("none.png"), 0, 0, [])
        images.exr(self.path("one.exr"), 1, 1, {"Y": [3.0]})
        images.exr(self.path("row.exr"), 9, 1, {"Y": [3.0] * 9})
        for name in ("none.exr", "none.png", "one.exr", "row.exr"):
            with self.subTest(name=name):
                self.assert_heightmap_refused(name)

    def test_no_data_at_all(self):
        for name, value in (("nan.exr", float("nan")), ("inf.exr", float("inf"))):
            with self.subTest(name=name):
                images.exr(self.path(name), 8, 8, {"Y": [value] * 64})
                self.assert_heightmap_refused(name)

    def test_bad_scales(self):
        for option in ("--cell-size", "--height-scale"):
            for value in ("0", "nan", "inf", "x") + (("-1",) if option == "--cell-size" else ()):
                with self.subTest(option=option, value=value):
                    self.assert_refused(self.amplify("cliff.exr", "-o", "out/a.ply", option + "=" + value))

    def test_a_colour_image_says_which_channel_is_taken(self):
        ramp = [float(x) for y in range(8) for x in range(8)]
        images.exr(self.path("rgb.exr"), 8, 8, {"R": ramp, "G": ramp, "B": ramp})
        result = self.amplify("rgb.exr", "--strata", "small.json", "--dry-run")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("rgb.exr", result.stderr)
        self.assertIn("R", result.stderr)

    def test_a_few_missing_samples_do_no_harm(self):
        heights = images.cliff()
        for i in (100, 101, 1200, 2000):
            heights[i] = float("nan") if i % 2 else float("inf")
        images.exr(self.path("holes.exr"), 48, 48, {"Y": heights})
        result = self.amplify("holes.exr", "--strata", "small.json", "--resolution", "0.5", "-o", "out/a.ply")
        self.assertEqual(result.returncode, 0, result.stderr)
        low, high = bounds_of_ply(self.path("out", "a.ply"))
        self.assertGreater(low[2], -8)
        self.assertLess(high[2], 25)


class BadStrata(ProgramTest):
    def test_missing_directory_and_empty(self):
        self.assert_refused(self.amplify("cliff.exr", "--strata", "gone.json", "-o", "out/a.ply"), "gone.json")
        self.assert_refused(self.amplify("cliff.exr", "--strata", ".", "-o", "out/a.ply"), "folder")
        self.assert_strata_refused("")

    def test_json_that_does_not_parse_names_line_and_column(self):
        self.assert_strata_refused('{\n  "placement": {,}\n}', "bad.json:2:17")

    def test_unknown_keys_name_the_nearest(self):
        self.assert_strata_refused('{"placement": {"slope_degs": 4}}', "bad.json:1:16", "slope_degs", "slope_deg")

    def test_wrong_types(self):
        self.assert_strata_refused('{"materials": [{"tile_side": "wide"}]}', "tile_side", "wide")

    def test_values_out_of_range_name_bound_and_value(self):
        self.assert_strata_refused('{"placement": {"slope_deg": 99}}', "slope_deg", "89", "99")

    def test_a_layer_of_no_material(self):
        self.assert_strata_refused('{"strata": {"layers": [{"material": "cheese"}]}}', "bad.json:1:25", "cheese")

    def test_missing_relief_image(self):
        self.assert_strata_refused('{"materials": [{"relief": {"image": "gone.png"}}]}', "bad.json:1:28", "gone.png")

    def test_a_relief_that_is_no_image(self):
        self.write("fake.png", "no image")
        self.write("bad.json", '{"materials": [{"relief": {"image": "fake.png"}}]}')
        self.assert_refused(self.amplify("cliff.exr", "--strata", "bad.json", "-o", "out/a.ply"), "fake.png")


class BadOptions(ProgramTest):
    def test_usage(self):
        self.assert_refused(self.amplify(), "HEIGHTMAP")
        self.assert_refused(self.amplify("cliff.exr", "--resolutoin", "1"), "--resolution")
        self.assert_refused(self.amplify("cliff.exr", "--threads", "-3", "-o", "out/a.ply"), "threads")
        self.assert_refused(self.amplify("cliff.exr", "--nodata", "spike", "-o", "out/a.ply"), "nodata")

    def test_an_option_with_too_few_values_is_named_not_what_follows_it(self):
        self.assert_refused(self.amplify("cliff.exr", "--region", "0", "0", "1"), "--region: expected 4 values")
        self.assert_refused(self.amplify("cliff.exr", "--region", "0", "0", "1", "-o", "out/a.ply"),
                            "--region: expected numbers")

    def test_a_refusal_after_the_terrain_was_read_stands_alone(self):
        # The file gives no cell size, which is worth a line, and the height of the wall is only known to the mesher.
        images.exr(self.path("wall.exr"), 16, 16, {"Y": [9e5 * (x > 8) for y in range(16) for x in range(16)]})
        result = self.amplify("wall.exr", "--strata", "small.json", "--resolution", "0.5", "-o", "out/a.ply")
        self.assert_refused(result, "resolution")

    def test_region_outside_names_the_terrain(self):
        result = self.amplify("cliff.exr", "--region", "100", "0", "200", "50", "-o", "out/a.ply")
        self.assert_refused(result, "region", "0 0 47 47", "100 0 200 50")

    def test_resolution_beyond_memory_says_what_fits(self):
        result = self.amplify("cliff.exr", "--resolution", "0.01", "--memory-limit", "0.05", "-o", "out/a.vdb")
        self.assert_refused(result, "resolution", "0.01", "memory")

    def test_outputs_that_cannot_be(self):
        self.assert_refused(self.amplify("cliff.exr", "-o", "gone/a.ply"), "gone")
        self.assert_refused(self.amplify("cliff.exr", "-o", "out/a.glb"), "a.glb", ".ply")
        self.assert_refused(self.amplify("cliff.exr", "-o", "cliff.exr/a.ply"), "cliff.exr")
        self.assert_refused(self.amplify("cliff.exr", "-o", "out"), "out")
        self.assert_refused(self.amplify("cliff.exr", "--report", "cliff.exr"), "cliff.exr")

    @unittest.skipIf(os.geteuid() == 0, "the superuser may write everywhere")
    def test_read_only_folder(self):
        os.chmod(self.path("out"), 0o555)
        self.assert_refused(self.amplify("cliff.exr", "-o", "out/a.ply"), "out")

    def test_a_camera_in_the_rock(self):
        result = self.small("--preview", "out/a.png", "--camera", "40", "24", "0", "0", "24", "5", "--quiet")
        self.assert_refused(result, "camera")

    def test_a_camera_that_looks_at_itself_is_refused_before_work(self):
        self.assert_refused(self.amplify("cliff.exr", "-o", "out/a.ply", "--preview", "out/a.png",
                                         "--camera", "1", "2", "3", "1", "2", "3"), "camera", "target")

    def test_a_spacing_that_the_terrain_makes_too_fine_names_file_and_material(self):
        self.assert_strata_refused('{"materials": [{"name": "slate", "sample_spacing": 0.001}]}', "bad.json:1:34", "sample_spacing",
                                   "0.001", "the terrain makes tile_side 11.75")
        self.assert_strata_refused('{"materials": [{"aperture": 0.5}]}', "bad.json:1:17", "aperture", "0.217", "tile_side")

    def test_help_and_version(self):
        for program in (AMPLIFY, POLYGONIZE):
            for option in ("--help", "--version"):
                result = self.run_program(program, option)
                self.assertEqual((result.returncode, result.stderr), (0, ""))
                self.assertNotEqual(result.stdout, "")


class BadScenes(ProgramTest):
    def assert_scene_refused(self, text, *words):
        self.write("scene.json", text)
        result = self.run_program(POLYGONIZE, "scene.json", "-o", "out/a.ply")
        self.assert_refused(result, "scene.json", *words, program="polygonize")

    def test_mistakes_in_scenes(self):
        self.assert_scene_refused('{"field": {"spere": {}}}', "scene.json:1:12", "sphere")
        self.assert_scene_refused('{"field": {"sphere": {"radius": -1}}}', "radius", "-1")
        self.assert_scene_refused('{"field": {"half_space": {}}}', "region")
        self.assert_scene_refused('{"field": {"sphere": {"radius": 1e-300}}}', "scene.json:1:23", "radius", "1e-06")
        self.write("scene.json", '{"field": {"transform": {"scale": 1e-5, "of": {"sphere": {"radius": 1e-5}}}}}')
        result = self.run_program(POLYGONIZE, "scene.json", "-o", "out/a.ply")
        self.assert_refused(result, "--resolution", "1e-06", program="polygonize")
        self.write("scene.json", '{"field": {"mesh": {"file": "gone.ply"}}}')
        result = self.run_program(POLYGONIZE, "scene.json", "-o", "out/a.ply")
        self.assert_refused(result, "gone.ply", program="polygonize")

    def test_other_inputs(self):
        for name, text in (("a.vdb", "no grid"), ("a.ply", "ply\nformat ascii 1.0\nelement vertex 1\n"), ("a.xyz", "1 2 3"),
                           ("a.stl", ""), ("a.obj", "v 0 0\n")):
            with self.subTest(name=name):
                self.write(name, text)
                result = self.run_program(POLYGONIZE, name, "-o", "out/a.ply")
                self.assert_refused(result, name, program="polygonize")


class Failures(ProgramTest):
    def test_a_full_disk_keeps_the_old_file(self):
        self.write("out/a.ply", "old")

        def limit():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (50000, 50000))

        result = self.small("-o", "out/a.ply", "--quiet", preexec_fn=limit)
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertEqual(len(result.stderr.splitlines()), 1, result.stderr)
        self.assertIn("a.ply", result.stderr)
        self.assertEqual(os.listdir(self.path("out")), ["a.ply"])
        with open(self.path("out", "a.ply")) as file:
            self.assertEqual(file.read(), "old")

    def test_interrupting_leaves_no_half_files(self):
        process = subprocess.Popen([AMPLIFY, "cliff.exr", "--strata", "small.json", "--resolution", "0.04", "--verbose",
                                    "-o", "out/a.ply"], cwd=self.folder, stderr=subprocess.PIPE, text=True)
        deadline = time.time() + 60
        seen = ""
        while "meshing" not in seen and time.time() < deadline:
            character = process.stderr.read(1)
            if not character:
                break
            seen += character
        self.assertIn("meshing", seen)
        process.send_signal(signal.SIGINT)
        _, rest = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 130, seen + rest)
        self.assertEqual(os.listdir(self.path("out")), [])

    def test_interrupting_while_libraries_start_is_clean(self):
        process = subprocess.Popen([AMPLIFY, "cliff.exr", "--resolution", "0.04", "-o", "out/a.ply"], cwd=self.folder,
                                   stderr=subprocess.PIPE, text=True, env={**os.environ, "LD_DEBUG": "files"})
        said = ""  # By the loader: the program's own handler stands before the libraries' constructors run.
        while "calling preinit" not in said:
            said = process.stderr.readline()
            self.assertNotEqual(said, "", "the loader calls nothing before the libraries' constructors")
        process.stderr.readline()
        process.stderr.readline()
        process.send_signal(signal.SIGINT)
        _, rest = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 130, rest[-1000:])
        self.assertIn("amplify: interrupted; no file was left in part\n", rest)
        self.assertEqual(os.listdir(self.path("out")), [])


def bounds_of_ply(path):
    with open(path, "rb") as file:
        data = file.read()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    header = data[:end].decode()
    lines = header.splitlines()
    count = next(int(line.split()[2]) for line in lines if line.startswith("element vertex"))
    vertex = lines[next(i for i, line in enumerate(lines) if line.startswith("element vertex")) + 1:]
    size = 0
    for line in vertex:
        if not line.startswith("property"):
            break
        size += {"float": 4, "uchar": 1, "ushort": 2}[line.split()[1]]
    points = [struct.unpack_from("<3f", data, end + i * size) for i in range(count)]
    return [min(p[i] for p in points) for i in range(3)], [max(p[i] for p in points) for i in range(3)]


class GoodRuns(ProgramTest):
    def test_outputs_are_written_and_stdout_is_free(self):
        result = self.small("-o", "out/a.ply", "-o", "out/a.obj", "--preview", "out/a.png", "--report", "out/a.json",
                            "--size", "64", "48", "--solid")
        self.assertEqual((result.returncode, result.stdout), (0, ""), result.stderr)
        self.assertEqual(sorted(os.listdir(self.path("out"))), ["a.json", "a.obj", "a.ply", "a.png"])
        with open(self.path("out", "a.json")) as file:
            report = json.load(file)
        self.assertTrue(report["mesh"]["closed"])
        self.assertGreater(report["replicated_blocks"], 0)
        for line in result.stderr.splitlines():
            self.assertTrue(line.startswith("amplify: "), line)

    def test_without_options_it_writes_beside_the_caller(self):
        images.exr(self.path("bump.exr"), 16, 16, {"Y": [0.5 * max(0, 6 - abs(x - 8)) for y in range(16) for x in range(16)]})
        result = self.amplify("bump.exr", "--size", "64", "48")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertTrue(os.path.exists(self.path("bump_rock.ply")))
        self.assertTrue(os.path.exists(self.path("bump_rock.png")))

    def test_quiet_is_quiet(self):
        result = self.small("-o", "out/a.stl", "--quiet")
        self.assertEqual((result.returncode, result.stdout, result.stderr), (0, "", ""))

    def test_a_dry_run_only_tells(self):
        result = self.small("-o", "out/a.ply", "--dry-run")
        self.assertEqual(result.returncode, 0, result.stderr)
        for word in ("blocks", "cells", "triangles", "seconds", "out/a.ply"):
            self.assertIn(word, result.stdout)
        self.assertEqual(os.listdir(self.path("out")), [])

    def test_threads_do_not_change_a_byte(self):
        for threads in ("1", "2"):
            self.small("-o", "out/%s.ply" % threads, "--threads", threads, "--quiet")
        with open(self.path("out", "1.ply"), "rb") as one, open(self.path("out", "2.ply"), "rb") as two:
            self.assertEqual(one.read(), two.read())

    def test_a_level_set_holds_the_parts_that_the_mesh_holds(self):
        ball = '{"sphere": {"radius": 0.5}}'
        hollow = '{"difference": {"a": {"sphere": {"centre": [3, 0, 0]}}, "b": {"sphere": {"centre": [3, 0, 0], "radius": 0.6}}}}'
        self.write("scene.json", '{"resolution": 0.1, "field": {"union": [%s, %s]}}' % (ball, hollow))

        def triangles(*options):
            made = self.run_program(POLYGONIZE, "scene.json", "-o", "out/a.vdb", *options)
            self.assertEqual(made.returncode, 0, made.stderr)
            read = self.run_program(POLYGONIZE, "out/a.vdb", "-o", "out/a.ply", "--keep-voids", "--resolution", "0.1")
            self.assertEqual(read.returncode, 0, read.stderr)
            return int(read.stderr.split(": ")[-1].replace(" triangles", "").replace(" ", ""))

        everything, solid, largest = triangles("--keep-voids"), triangles(), triangles("--parts", "largest")
        self.assertLess(solid, 0.9 * everything)
        self.assertLess(largest, 0.9 * solid)

    def test_polygonize_goes_round_through_its_own_formats(self):
        self.write("scene.json", '{"field": {"smooth_union": {"radius": 0.3, "of": [{"box": {"rounding": 0.1}},'
                   '{"sphere": {"centre": [0.8, 0.8, 0.8]}}]}}}')
        chain = [("scene.json", "out/a.vdb"), ("out/a.vdb", "out/b.stl"), ("out/b.stl", "out/c.obj"), ("out/c.obj", "out/d.ply")]
        for source, target in chain:
            result = self.run_program(POLYGONIZE, source, "-o", target, "--resolution", "0.05", "--quiet")
            self.assertEqual((result.returncode, result.stderr), (0, ""))
        low, high = bounds_of_ply(self.path("out", "d.ply"))
        for axis in range(3):
            self.assertAlmostEqual(low[axis], -1.0, delta=0.06)
            self.assertAlmostEqual(high[axis], 1.8, delta=0.06)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[3:])
