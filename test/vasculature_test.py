"""anthesis vasculature: veins of a digitised head, and the files they go into."""
import csv
import hashlib
import json
import os

from program import BAD_DATA, DONE, IO_FAILED, SOURCE, USAGE, ProgramTest, main, scene

REFERENCE = os.environ.get("ANTHESIS_REFERENCE") or os.path.join(SOURCE, "..", "shared", "reference")
SIZES = (0.012, 0.03, 0.1)
HEAD = "Sunflower-cap"  # a folder; its name says whose size and veins


def stage(size):
    """A cap of radius and height `size`, its landmark at the rim and the ring, which comes to lie at the apex."""
    ring = {SIZES[0]: 0.6, SIZES[1]: 0.3, SIZES[2]: 0.02}[size]
    points = [(0, 1, 3), (0.6, 1, 1), (1, 0.7, 1), (1.1, 0.3, 1), (0.9, 0, 3)]
    return "\n".join(["cver 1 3", "name: stage", "points: 5 9", "type: or", "samples: 100", "markers: 2", "0 0.9 0 0",
                      f"1 {ring} 0 0"] + [f"{size * x:.6f} {size * y:.6f} 0 {m}" for x, y, m in points]) + "\n"


def function(name, values):
    points = "".join(f"{i / (len(values) - 1):.6f} {value}\n" for i, value in enumerate(values))
    return f"fver 1 1\nname: {name}\nsamples: 100\nflip: off\npoints: {len(values)}\n{points}"


def png_size(data):
    return int.from_bytes(data[16:20], "big"), int.from_bytes(data[20:24], "big")


class Vasculature(ProgramTest):
    def setUp(self):
        super().setUp()
        os.mkdir(self.path(HEAD))
        self.write(f"{HEAD}/stages.cset",
                   "contourgalleryver 1 1\nitems: 3\n" + "".join(stage(size) for size in SIZES))
        self.write(f"{HEAD}/functions.fset", "funcgalleryver 1 1\nitems: 1\n" +
                   function("thresholdDistanceFunc", [0.3, 0.25, 0.2, 0.2, 0.2]))
        self.write(f"{HEAD}/few.prims", "3\n0 100 0.8 0.5 1\n1 200 0.6 3.5 0\n2 2000 0.3 1.5 0\n")

    def write(self, name, text):
        with open(self.path(name), "w", encoding="utf-8") as file:
            file.write(text)

    def rows(self, name):
        lines = self.content(name).decode().splitlines()
        return list(csv.DictReader(line for line in lines if not line.startswith("#")))

    def test_a_head_of_ones_own_gets_veins(self):
        names = ["veins.csv", "veins.swc", "veins.ply", "primordia.csv", "measures.csv"]
        outputs = [word for name in names for word in ("-o", name)]
        report = json.loads(self.expect(DONE, "vasculature", HEAD, "--like", "bellis", "--with",
                                        "head.active_ring.bract_landmark=1", "--json", *outputs).out)
        self.assertEqual(report["unconnected"], 0)
        self.assertLess(report["brought_back"], 0.01 * report["vertices"])
        count = sum(report["primordia"].values())
        self.assertGreater(count, 15)
        self.assertEqual([os.path.basename(output["path"]) for output in report["outputs"]], names)
        veins = self.rows("veins.csv")
        self.assertEqual(len(veins), report["vertices"])
        swc = [line.split() for line in self.content("veins.swc").decode().splitlines() if not line.startswith("#")]
        parents = {row["parent"] for row in veins}
        shown = [row for row in veins if row["parent"] or row["vertex"] in parents]  # without the rest of the ring
        self.assertEqual(len(swc), len(shown))
        self.assertEqual(sum(row[6] == "-1" for row in swc), sum(row["parent"] == "" for row in shown))
        primordia = self.rows("primordia.csv")
        self.assertEqual(len(primordia), count)
        for row in primordia:
            self.assertEqual(veins[int(row["vertex"])]["primordium"], row["primordium"])
        measures = self.rows("measures.csv")
        self.assertEqual({row["connected"] for row in measures}, {"1"})
        self.assertEqual(len({row["bundle"] for row in measures}), report["ring_vertices_used"])
        self.assertTrue(self.content("veins.ply").startswith(b"ply\n"))

    def test_primordia_may_come_from_a_file_of_the_folder(self):
        for flags in ([], ["--mean-value"], ["--source", "paper"], ["--clock", "consistent"], ["--as-published"]):
            report = json.loads(self.expect(DONE, "vasculature", HEAD, "--primordia", "few.prims", "--json",
                                            *flags).out)
            self.assertEqual(report["primordia"], {"bract": 1, "floret": 2}, flags)
            self.assertEqual(report["unconnected"], 0, flags)
            self.assertGreater(report["vertices"], 125, flags)

    def test_one_seed_makes_one_head(self):
        for name, flags in (("a", ["--threads", "1"]), ("b", []), ("c", ["--seed", "2"])):
            self.expect(DONE, "vasculature", HEAD, "--primordia", "few.prims", "-o", name + ".csv", "-o",
                        name + ".ply", *flags)
        for ending in (".csv", ".ply"):
            self.assertEqual(self.content("a" + ending), self.content("b" + ending))
            self.assertNotEqual(self.content("a" + ending), self.content("c" + ending))

    def test_a_folder_becomes_a_species_that_runs(self):
        self.expect(DONE, "import", "vlab", HEAD, "--like", "sunflower", "-o", "head.toml")
        of_folder = json.loads(self.expect(DONE, "vasculature", HEAD, "--json").out)
        of_file = json.loads(self.expect(DONE, "vasculature", "head.toml", "--json").out)
        for key in ("primordia", "vertices", "ring_vertices_used", "total_length_mm"):
            self.assertEqual(of_folder[key], of_file[key])
        # Files of VLab do not say how large the head is, nor anything about veins.
        os.rename(self.path(HEAD), self.path("mine"))
        self.expect(USAGE, "import", "vlab", "mine", "-o", "mine.toml",
                    message="files of VLab state neither size nor veins of a growing head: say --like bellis, sunflower "
                            "or gerbera, or --width-mm for a head without veins")
        self.expect(USAGE, "vasculature", "mine",
                    message="files of VLab state neither size nor veins: say --like bellis, sunflower or gerbera for mine")
        self.expect(DONE, "import", "vlab", "mine", "--width-mm", "3", "-o", "mine.toml")
        organs = json.loads(self.expect(DONE, "grow", "head.toml", "-o", "head.csv", "--json").out)["organs"]
        self.assertEqual(organs["floret"], of_file["primordia"]["floret"])

    def test_pictures_and_models_over_the_development(self):
        outputs = ["-o", "growing.glb", "-o", "growing.png"]
        report = json.loads(self.expect(DONE, "vasculature", HEAD, "--frames", "3", "--size", "64", "--quality", "draft",
                                        "--json", *outputs).out)
        names = [os.path.basename(output["path"]) for output in report["outputs"]]
        self.assertEqual(names, ["growing.glb", "growing_0000.png", "growing_0001.png", "growing_0002.png"])
        self.assertIn(b'"development"', self.content("growing.glb"))
        self.assertNotEqual(self.content("growing_0001.png"), self.content("growing_0002.png"))
        self.expect(DONE, "vasculature", HEAD, "--frames", "3", "--columns", "2", "--size", "64", "--quality", "draft",
                    "-o", "sheet.png")
        self.assertEqual(png_size(self.content("sheet.png")), (128, 128))
        for flags in (["--cut", "half"], ["--cut", "slice", "--view", "side"], ["--view", "bottom"], ["--no-receptacle"],
                      ["--scale-bar"], ["--show-primordia"], ["--at", "0.5"]):
            self.expect(DONE, "vasculature", HEAD, "--size", "64", "--quality", "draft", "-o", "one.png", *flags)
            self.assertNotEqual(self.content("one.png"), self.content("growing_0002.png"), flags)

    def test_the_young_head_has_fewer_veins(self):
        counts = [json.loads(self.expect(DONE, "vasculature", HEAD, "--at", at, "--json").out)["vertices"]
                  for at in ("0.2", "0.6", "1")]
        self.assertLess(counts[0], counts[1])
        self.assertLess(counts[1], counts[2])

    def test_the_section_is_drawn(self):
        self.expect(DONE, "vasculature", HEAD, "-o", "section.svg", "-o", "growth.svg", "-o", "displacement.svg",
                    "--control", "3", "--control", "5")
        texts = [self.content(name).decode() for name in ("section.svg", "growth.svg", "displacement.svg")]
        for text in texts:
            self.assertTrue(text.rstrip().endswith("</svg>"))
        self.assertIn("control point 3", texts[0])
        self.assertNotIn("control point 4", texts[0])
        for control in ("9999", "-3", "a"):
            result = self.run_program("vasculature", HEAD, "-o", "section.svg", "--control", control)
            self.assertEqual(result.status, USAGE)
            self.assertIn("--control must be a whole number in [0, ", result.err)

    def test_vlab_can_go_on_with_it(self):
        report = json.loads(self.expect(DONE, "vasculature", HEAD, "-o", "head.cntrs", "-o", "head_stable.prims", "-o",
                                        "head_final.prims", "--weights", "head.raw", "--json").out)
        count = sum(report["primordia"].values())
        stable = self.content("head_stable.prims").decode().split("\n")
        self.assertEqual(int(stable[0]), count)
        self.assertEqual(len([line for line in stable[1:] if line]), count)
        frames, points = (int(line) for line in self.content("head.cntrs").split()[:2])
        raw = self.content("head.raw")
        self.assertEqual(int.from_bytes(raw[:4], "little"), frames)
        self.assertEqual(report["outputs"][-1]["sha256"], hashlib.sha256(raw).hexdigest())
        self.assertGreater(points, 5)
        # What was written can be read: the head's own primordia as a file.
        again = json.loads(self.expect(DONE, "vasculature", HEAD, "--primordia", "head_stable.prims", "--json").out)
        self.assertEqual(again["primordia"], report["primordia"])
        self.assertLess(abs(again["vertices"] - report["vertices"]), 0.1 * report["vertices"])

    def test_numbers_vary_over_a_range(self):
        self.expect(DONE, "vasculature", HEAD, "--primordia", "few.prims", "--vary", "mu_sec=0:1:0.5", "--vary",
                    "ring_vertices=10:20:10", "-o", "table.csv", "-o", "sheet.png", "--size", "48", "--quality", "draft")
        rows = self.rows("table.csv")
        self.assertEqual([(row["mu_sec"], row["ring_vertices"]) for row in rows],
                         [(a, b) for a in ("0", "0.5", "1") for b in ("10", "20")])
        self.assertTrue(all(int(row["vertices"]) > 10 for row in rows))
        self.assertTrue(all(row["connected"] == "3" for row in rows))
        self.assertEqual(png_size(self.content("sheet.png")), (96, 144))
        one = json.loads(self.expect(DONE, "vasculature", HEAD, "--primordia", "few.prims", "--with", "mu_sec=0.5",
                                     "--with", "ring_vertices=20", "--json").out)
        self.assertEqual(str(one["vertices"]), rows[3]["vertices"])
        for words, message in (
                (["--vary", "mu_sec=0:1"], "--vary must be KEY=FROM:TO:STEP or KEY=xFROM:TO:STEP, got mu_sec=0:1"),
                (["--vary", "mu_sec=1:0:0.1"], "--vary must go up from FROM to TO by a STEP > 0, got mu_sec=1:0:0.1"),
                (["--vary", "mu_sec=0:1:0.5", "-o", "a.glb"], "-o must end in .csv or .png, got a.glb"),
                (["--vary", "mu_sec=0:1:0.0001"], "--vary must give at most 1000 values, got mu_sec=0:1:0.0001"),
                (["--vary", "mu_sec=0:1:0.5", "--frames", "3"], "--vary goes with neither --frames nor --weights")):
            self.expect(USAGE, "vasculature", HEAD, *words, message=message)

    def test_seeds_vary_too(self):
        self.expect(DONE, "vasculature", HEAD, "--vary", "seed=1:3:1", "-o", "table.csv")
        rows = self.rows("table.csv")
        self.assertEqual([row["seed"] for row in rows], ["1", "2", "3"])
        self.assertEqual(len({row["total_length_mm"] for row in rows}), 3)
        one = json.loads(self.expect(DONE, "vasculature", HEAD, "--seed", "2", "--json").out)
        self.assertEqual(str(one["vertices"]), rows[1]["vertices"])
        self.assertNotIn(b"# seed: ", self.content("table.csv"))
        self.expect(USAGE, "vasculature", HEAD, "--vary", "seed=0:1:0.5",
                    message="--vary seed must give whole numbers, got seed=0:1:0.5")

    def test_tables_and_tubes_of_each_moment(self):
        self.expect(DONE, "vasculature", HEAD, "--frames", "3", "-o", "x.csv", "-o", "x.swc", "-o", "x.ply", "-o",
                    "x-measures.csv", "-o", "x-development.csv")
        names = [f"x_{i:04d}.{ending}" for ending in ("csv", "swc", "ply") for i in range(3)]
        names += [f"x-measures_{i:04d}.csv" for i in range(3)] + ["x-development.csv", HEAD]
        self.assertEqual(sorted(os.listdir(self.folder)), sorted(names))
        self.expect(DONE, "vasculature", HEAD, "--at", "0.5", "-o", "half.csv", "-o", "half.ply")
        self.assertEqual(self.content("half.csv"), self.content("x_0001.csv"))
        self.assertEqual(self.content("half.ply"), self.content("x_0001.ply"))
        rows = self.rows("x-development.csv")
        self.assertEqual([row["vertices"] for row in rows], [str(len(self.rows(f"x_000{i}.csv"))) for i in range(3)])
        grown = [int(row["florets"]) + int(row["bracts"]) for row in rows]
        self.assertEqual(grown, sorted(grown))
        self.assertLess(grown[0], grown[2])

    def test_heads_of_a_range_are_shown_at_one_scale_and_none_is_cut_off(self):
        # Of half the size and whole. The sheet is two cells of 64 pixels.
        self.expect(DONE, "vasculature", scene("cap_head"), "--vary", "head.active_ring.sections[2].points=x0.5:1:0.5",
                    "-o", "sheet.png", "-o", "table.csv", "--size", "64", "--quality", "draft", "--view", "side",
                    "--backdrop", "none")
        self.assertEqual([row["head.active_ring.sections[2].points_factor"] for row in self.rows("table.csv")],
                         ["0.5", "1"])
        rows = self.coverage("sheet.png")[:-12]  # without the caption
        self.assertEqual(len(rows[0]), 128)
        small, large = ([row[start:start + 64] for row in rows] for start in (0, 64))
        widths = [max(sum(alpha > 0 for alpha in row) for row in cell) for cell in (small, large)]
        self.assertGreater(widths[1], 32)
        self.assertAlmostEqual(widths[0] / widths[1], 0.5, delta=0.1)
        for cell in (small, large):
            self.assertFalse(any(cell[0]) or any(row[0] or row[-1] for row in cell))

    def test_any_number_of_the_species_can_be_changed(self):
        one = json.loads(self.expect(DONE, "vasculature", HEAD, "--with", "ring_vertices=3", "--with",
                                     "head.active_ring.threshold_frozen_above=5", "--json").out)
        self.assertLessEqual(one["ring_vertices_used"], 3)
        self.expect(USAGE, "vasculature", HEAD, "--with", "mu_sek=1",
                    message="--with: vasculature.mu_sek is not known; did you mean mu_sec?")
        self.expect(USAGE, "vasculature", HEAD, "--with", "mu_sec=-1",
                    message="--with: vasculature.sector_weight must be in [0, 1e+06], got -1")
        self.expect(USAGE, "vasculature", HEAD, "--with", "mu_sec",
                    message="--with must be KEY=NUMBER or KEY=xFACTOR, got mu_sec")

    def test_what_is_wrong_is_said(self):
        self.expect(USAGE, "vasculature", HEAD, "--like", "rose",
                    message="--like must be bellis, sunflower or gerbera, got rose")
        self.expect(USAGE, "vasculature", HEAD, "--source", "text",
                    message="--source must be paper or as_published, got text")
        self.expect(USAGE, "vasculature", HEAD, "-o", "veins.obj",
                    message="-o must end in .csv, .swc, .ply, .glb, .png, .svg, .prims or .cntrs, got veins.obj")
        self.expect(USAGE, "vasculature", HEAD, "-o", "veins.png", "--cut", "thin",
                    message="--cut must be whole, half or slice, got thin")
        self.expect(USAGE, "vasculature", HEAD, "--at", "0.5", "--frames", "3",
                    message="--at is for one time and --frames for several: give one of them")
        self.expect(USAGE, "vasculature", HEAD, "--primordia", "few.prims", "-o", "a.prims",
                    message="a .prims file is of primordia that grow on the head: leave --primordia out")
        self.expect(USAGE, "vasculature", "daisy", "--like", "bellis",
                    message="--like is for a FOLDER; a species file states its own")
        self.expect(BAD_DATA, "vasculature", "daisy",
                    message="daisy must have a table [vasculature], as bellis-head or sunflower-head has")
        self.expect(IO_FAILED, "vasculature", HEAD, "--primordia", "none.prims")
        os.remove(self.path(f"{HEAD}/functions.fset"))
        self.expect(BAD_DATA, "vasculature", HEAD,
                    message="functions must hold one named thresholdDistanceFunc, got none")
        os.remove(self.path(f"{HEAD}/stages.cset"))
        self.expect(BAD_DATA, "vasculature", HEAD,
                    message="contours must come with a .con or .cset file, got none")

    def test_bellis_is_the_published_head(self):
        folder = os.path.join(REFERENCE, "heads", "bellis")
        if not os.path.isdir(folder):
            self.skipTest("no reference data")
        report = json.loads(self.expect(DONE, "vasculature", folder, "--by-id", "--primordia",
                                        os.path.join("vasculature", "bellis_stable.prims"), "--json").out)
        self.assertEqual(report["primordia"], {"bract": 28, "floret": 392})
        self.assertLess(abs(report["vertices"] - 14172), 0.02 * 14172)
        self.assertLess(abs(report["second_connections"] - 413), 10)
        self.assertIn(report["ring_vertices_used"], (7, 8, 9))
        self.assertEqual(report["unconnected"], 0)


if __name__ == "__main__":
    main()
