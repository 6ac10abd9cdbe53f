"""anthesis vasculature: veins of a digitised head, and the files they go into."""
import csv
import json
import os

from program import BAD_DATA, DONE, IO_FAILED, SOURCE, USAGE, ProgramTest, main

REFERENCE = os.environ.get("ANTHESIS_REFERENCE") or os.path.join(SOURCE, "..", "shared", "reference")
SIZES = (0.012, 0.03, 0.1)


def stage(size):
    """A cap of radius and height `size`, its landmark at the rim and the ring, which comes to lie at the apex."""
    ring = {SIZES[0]: 0.6, SIZES[1]: 0.3, SIZES[2]: 0.02}[size]
    points = [(0, 1, 3), (0.6, 1, 1), (1, 0.7, 1), (1.1, 0.3, 1), (0.9, 0, 3)]
    return "\n".join(["cver 1 3", "name: stage", "points: 5 9", "type: or", "samples: 100", "markers: 2", "0 0.9 0 0",
                      f"1 {ring} 0 0"] + [f"{size * x:.6f} {size * y:.6f} 0 {m}" for x, y, m in points]) + "\n"


def function(name, values):
    points = "".join(f"{i / (len(values) - 1):.6f} {value}\n" for i, value in enumerate(values))
    return f"fver 1 1\nname: {name}\nsamples: 100\nflip: off\npoints: {len(values)}\n{points}"


class Vasculature(ProgramTest):
    def setUp(self):
        super().setUp()
        os.mkdir(self.path("cap"))
        self.write("cap/stages.cset", "contourgalleryver 1 1\nitems: 3\n" + "".join(stage(size) for size in SIZES))
        self.write("cap/functions.fset", "funcgalleryver 1 1\nitems: 1\n" +
                   function("thresholdDistanceFunc", [0.3, 0.25, 0.2, 0.2, 0.2]))
        self.write("cap/few.prims", "3\n0 100 0.8 0.5 1\n1 200 0.6 3.5 0\n2 2000 0.3 1.5 0\n")

    def write(self, name, text):
        with open(self.path(name), "w", encoding="utf-8") as file:
            file.write(text)

    def rows(self, name):
        lines = self.content(name).decode().splitlines()
        return list(csv.DictReader(line for line in lines if not line.startswith("#")))

    def test_a_head_of_ones_own_gets_veins(self):
        names = ["veins.csv", "veins.swc", "veins.ply", "primordia.csv", "measures.csv"]
        outputs = [word for name in names for word in ("-o", name)]
        report = json.loads(self.expect(DONE, "vasculature", "cap", "--parameters", "bellis", "--bract-landmark", "1",
                                        "--json", *outputs).out)
        self.assertEqual(report["unconnected"], 0)
        count = sum(report["primordia"].values())
        self.assertGreater(count, 15)
        self.assertEqual([os.path.basename(output["path"]) for output in report["outputs"]], names)
        veins = self.rows("veins.csv")
        self.assertEqual(len(veins), report["vertices"])
        swc = [line.split() for line in self.content("veins.swc").decode().splitlines() if not line.startswith("#")]
        self.assertEqual(len(swc), report["vertices"])
        self.assertEqual(sum(row[6] == "-1" for row in swc), sum(row["parent"] == "" for row in veins))
        primordia = self.rows("primordia.csv")
        self.assertEqual(len(primordia), count)
        for row in primordia:
            self.assertEqual(veins[int(row["vertex"])]["primordium"], row["primordium"])
        measures = self.rows("measures.csv")
        self.assertEqual({row["connected"] for row in measures}, {"1"})
        self.assertEqual(len({row["bundle"] for row in measures}), report["ring_vertices_used"])
        self.assertTrue(self.content("veins.ply").startswith(b"ply\n"))

    def test_primordia_may_come_from_a_file_of_the_folder(self):
        for flags in ([], ["--mean-value"], ["--set", "paper"], ["--clock", "consistent"], ["--as-published"]):
            report = json.loads(self.expect(DONE, "vasculature", "cap", "--primordia", "few.prims", "--json",
                                            *flags).out)
            self.assertEqual(report["primordia"], {"bract": 1, "floret": 2}, flags)
            self.assertEqual(report["unconnected"], 0, flags)
            self.assertGreater(report["vertices"], 125, flags)

    def test_one_seed_makes_one_head(self):
        for name, flags in (("a", ["--threads", "1"]), ("b", []), ("c", ["--seed", "2"])):
            self.expect(DONE, "vasculature", "cap", "--primordia", "few.prims", "-o", name + ".csv", "-o",
                        name + ".ply", *flags)
        for ending in (".csv", ".ply"):
            self.assertEqual(self.content("a" + ending), self.content("b" + ending))
            self.assertNotEqual(self.content("a" + ending), self.content("c" + ending))

    def test_what_is_wrong_is_said(self):
        self.expect(USAGE, "vasculature", "cap", "--parameters", "rose",
                    message="--parameters must be bellis, sunflower or gerbera, got rose")
        self.expect(USAGE, "vasculature", "cap", "--set", "text",
                    message="--set must be as-published or paper, got text")
        self.expect(USAGE, "vasculature", "cap", "-o", "veins.obj",
                    message="-o must end in .csv, .swc or .ply, got veins.obj")
        self.expect(BAD_DATA, "vasculature", "cap",
                    message="bract_landmark must be one of the profile's 1, got 8")
        self.expect(IO_FAILED, "vasculature", "cap", "--primordia", "none.prims")
        os.remove(self.path("cap/functions.fset"))
        self.expect(BAD_DATA, "vasculature", "cap",
                    message="cap must have a function thresholdDistanceFunc, or say where primordia are: "
                            "--primordia FILE")
        os.remove(self.path("cap/stages.cset"))
        self.expect(BAD_DATA, "vasculature", "cap", "--primordia", "few.prims",
                    message="contours must have at least 3 stages with markers, got 0")

    def test_bellis_is_the_published_head(self):
        folder = os.path.join(REFERENCE, "heads", "bellis")
        if not os.path.isdir(folder):
            self.skipTest("no reference data")
        report = json.loads(self.expect(DONE, "vasculature", folder, "--parameters", "bellis", "--primordia",
                                        os.path.join("vasculature", "bellis_stable.prims"), "--json").out)
        self.assertEqual(report["primordia"], {"bract": 28, "floret": 392})
        self.assertLess(abs(report["vertices"] - 14172), 0.02 * 14172)
        self.assertLess(abs(report["second_connections"] - 413), 10)
        self.assertIn(report["ring_vertices_used"], (7, 8, 9))
        self.assertEqual(report["unconnected"], 0)


if __name__ == "__main__":
    main()
