"""anthesis pattern and import: what pattern came out, of plants, of measured heads, of models and of VLab's files."""
import csv
import json
import math
import os

from program import BAD_DATA, DONE, SOURCE, USAGE, ProgramTest, main

REFERENCE = os.environ.get("ANTHESIS_REFERENCE") or os.path.join(SOURCE, "..", "shared", "reference")

def golden_spiral(count):
    golden = 2 * math.pi * (2 - (1 + math.sqrt(5)) / 2)
    return [(math.sqrt(k + 0.5) * math.cos(k * golden), math.sqrt(k + 0.5) * math.sin(k * golden))
            for k in range(count)]


class Parastichies(ProgramTest):
    def test_a_plant_says_what_pattern_it_has(self):
        words = self.expect(DONE, "pattern", "sunflower").out
        self.assertIn("34 counter-clockwise, 55 clockwise: Fibonacci", words)
        self.assertIn("divergence 137.51 degrees", words)
        report = json.loads(self.expect(DONE, "pattern", "sunflower", "--json").out)
        self.assertIn([34, 55], [stretch["families"] for stretch in report["parastichies"]])
        self.assertEqual(report["warnings"], [])

    def test_the_analysis_is_written_in_three_forms(self):
        self.expect(DONE, "pattern", "daisy", "--parastichies", "a.svg", "--parastichies", "a.csv", "--parastichies",
                    "a.json", "--parastichy-organs", "organs.csv", "--json")
        self.assertIn(b"</svg>", self.content("a.svg"))
        lines = self.content("a.csv").decode().splitlines()
        rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))
        found = json.loads(self.content("a.json"))["parastichies"]
        self.assertEqual([[int(row["m"]), int(row["n"])] for row in rows], [stretch["families"] for stretch in found])
        organs = [line for line in self.content("organs.csv").decode().splitlines() if not line.startswith("#")]
        self.assertEqual(len(organs), 1 + sum(int(row["organs"]) for row in rows))

    def test_a_measured_head_needs_no_order(self):
        places = golden_spiral(600)
        with open(self.path("head.csv"), "w", encoding="utf-8") as file:
            file.write("x,y,z\n" + "".join(f"{x},{y},0\n" for x, y in sorted(places)))
        report = json.loads(self.expect(DONE, "pattern", "--measured", "head.csv", "--json").out)
        outermost = report["parastichies"][-1]
        self.assertEqual(sorted(outermost["families"]), [34, 55])
        self.assertEqual(report["organs"], 600)

    def test_a_bad_table_is_refused_with_its_place(self):
        with open(self.path("head.csv"), "w", encoding="utf-8") as file:
            file.write("x,y,z\n1,2,3\n1,2,deep\n")
        self.expect(BAD_DATA, "pattern", "--measured", "head.csv",
                    message="head.csv:3:5: must be a finite number for z, got deep")

    def test_views_and_formats_are_named(self):
        self.expect(USAGE, "pattern", "daisy", "--parastichies", "a.png",
                    message="--parastichies must end in .svg, .csv or .json, got a.png")
        self.expect(USAGE, "pattern", "daisy", "--parastichies", "a.svg", "--parastichy-view", "round",
                    message="--parastichy-view must be polar or unrolled, got round")

    def test_a_waist_too_sharp_for_its_organs_is_named(self):
        with open(self.path("waist.toml"), "w", encoding="utf-8") as file:
            file.write("""name = "waist"
[head]
rule = "collision"
radius_mm = [[0, 2], [1, 2]]
[[head.receptacle]]
time = 0
points = [[0, 30], [10, 30], [10, 18], [1, 15], [10, 12], [10, 0]]
[[head.zones]]
organ = "bead"
from = 0
to = 1
[organs.bead]
[[organs.bead.columns]]
name = "bead"
pigment = "red"
[[organs.bead.columns.poses]]
stage = 0
profile_mm = [[0, 0], [1, 0], [1, 1], [0, 1]]
[pigments.red]
colour = "#aa2020"
""")
        result = self.expect(DONE, "pattern", "waist.toml")
        self.assertIn("anthesis: warning: head from ", result.err)
        self.assertIn("large for the curvature", result.err)


class Studies(ProgramTest):
    def test_models_agree_on_the_golden_angle_where_organs_are_small(self):
        self.expect(DONE, "pattern", "--study", "divergence", "--sizes", "0.07:0.1:4", "-o", "a.csv", "-o", "a.svg")
        lines = [line for line in self.content("a.csv").decode().splitlines() if not line.startswith("#")]
        rows = list(csv.DictReader(lines))
        self.assertEqual({row["model"] for row in rows}, {"contact pressure", "collision", "inhibition"})
        for row in rows:
            self.assertAlmostEqual(float(row["divergence_deg"]), 137.5, delta=2.0)
            self.assertIn((int(row["m"]), int(row["n"])), [(5, 8), (8, 13)])

    def test_studies_are_checked(self):
        self.expect(USAGE, "pattern", "--study", "spirals",
                    message="--study must be divergence, meristem-modes, self-similar or hierarchy, got spirals")
        self.expect(USAGE, "pattern", "--study", "divergence", "--sizes", "0.1",
                    message="--sizes must be SMALLEST:LARGEST:COUNT, got 0.1")
        self.expect(USAGE, "pattern", "--study", "divergence", "--sizes", "0.4:0.1:3",
                    message="--sizes must run upwards, got 0.4:0.1:3")
        self.expect(USAGE, "pattern", "--study", "hierarchy", message="say where to draw: -o figure.svg")


class Import(ProgramTest):
    def test_what_is_not_there_is_said(self):
        os.mkdir(self.path("empty"))
        self.expect(USAGE, "import", "maya", "empty", "-o", "a.toml",
                    message="anthesis imports from vlab, not from maya")
        self.assertEqual(self.run_program("import", "vlab", "empty", "-o", "a.toml").status, BAD_DATA)
        self.assertFalse(os.path.exists(self.path("a.toml")))

    def test_vlabs_ridley_model_runs(self):
        folder = os.path.join(REFERENCE, "vlab", "ridley")
        if not os.path.isdir(folder):
            self.skipTest("no reference data")
        self.expect(DONE, "import", "vlab", folder, "-o", "ridley.toml")
        report = json.loads(self.expect(DONE, "pattern", "ridley.toml", "--json").out)
        self.assertEqual(sum(report["organs"].values()), 123)
        self.assertIn([8, 13], [stretch["families"] for stretch in report["parastichies"]])


if __name__ == "__main__":
    main()
