"""What the program answers to right and wrong commands: help, messages, exit statuses, --json, progress, Ctrl-C."""
import hashlib
import json
import os
import pty
import re
import signal
import subprocess
import time

from program import DONE, INTERRUPTED, PROGRAM, SOURCE, USAGE, ProgramTest, main, scene

COMMANDS = ["grow", "pattern", "render", "species", "check", "import"]


class Help(ProgramTest):
    def test_every_command_has_help_that_begins_with_examples(self):
        for command in [[], *([name] for name in COMMANDS)]:
            result = self.expect(DONE, *command, "--help")
            self.assertRegex(result.out, r"^[^\n]+\n\nExamples:\n  anthesis ")
            self.assertIn("Usage: anthesis", result.out)
            self.assertEqual(result.err, "")
            for line in result.out.splitlines():
                self.assertLessEqual(len(line), 125, line)

    def test_version_is_the_projects(self):
        with open(os.path.join(SOURCE, "CMakeLists.txt"), encoding="utf-8") as file:
            version = re.search(r"project\(anthesis VERSION (\S+)", file.read()).group(1)
        self.assertEqual(self.expect(DONE, "--version").out, f"anthesis {version}\n")

    def test_examples_of_the_help_work(self):
        for command in ["pattern", "species"]:
            for example in re.findall(r"^  anthesis ([^>\n]*)", self.expect(DONE, command, "--help").out, re.M):
                if "mine.toml" in example:
                    with open(self.path("mine.toml"), "w", encoding="utf-8") as file:
                        file.write(self.expect(DONE, "species", "sunflower").out)
                self.expect(DONE, *example.split())


class Mistakes(ProgramTest):
    def test_commands_and_flags_have_hints(self):
        self.expect(USAGE, "grwo", message="there is no command grwo; did you mean grow? (anthesis --help lists them)")
        self.expect(USAGE, "grow", "sunflower", "--sed", "3", "-o", "a.glb",
                    message="--sed is not a flag of anthesis grow; did you mean --seed?")
        self.expect(USAGE, "grow", "sunflower", "--backdrop", "dark", "-o", "a.glb",
                    message="--backdrop is not a flag of anthesis grow")
        self.expect(USAGE, "grow", "sunflowr", "-o", "a.glb",
                    message='there is no species "sunflowr"; did you mean sunflower?')
        self.expect(USAGE, "grow", "sunflower", "daisy", "-o", "a.glb", message="anthesis grow has no use for daisy")

    def test_what_is_missing_is_asked_for(self):
        self.expect(USAGE)
        self.expect(USAGE, "grow", message="SPECIES is required")
        self.expect(USAGE, "grow", "sunflower", message="say where to write: -o flower.glb")
        self.expect(USAGE, "pattern", message="say which pattern: a species, --measured FILE, --vogel N for a flat disc, or "
                            "--study divergence")
        self.expect(USAGE, "render", "sunflower", message="say where to write one picture: -o flower.png")
        self.expect(USAGE, "species", "--check", message="--check needs a species or a file")

    def test_formats_are_named(self):
        self.expect(USAGE, "grow", "sunflower", "-o", "a.xyz",
                    message="-o must end in .glb, .obj, .ply, .pc2, .csv or .png, got a.xyz")
        self.expect(USAGE, "render", "sunflower", "-o", "a", message="-o must end in .png, got a")
        self.expect(USAGE, "grow", "sunflower", "-o", "a.glb", "-o", "a.glb", message="-o names a.glb twice")

    def test_every_number_is_checked_and_named(self):
        numbers = {  # flag: what it must be in
            ("grow", "--at"): "[0, 1]",
            ("grow", "--detail"): "(0, 8]",
            ("render", "--azimuth-deg"): "[-360, 360]",
            ("render", "--elevation-deg"): "[-90, 90]",
            ("render", "--exposure"): "[-10, 10]",
            ("pattern", "--cone-deg"): "(0, 180)",
            ("pattern", "--divergence-deg"): "(-360, 360)",
        }
        for (command, flag), limits in numbers.items():
            for value in ["nan", "-nan", "inf", "-inf", "1e300", "-1e300", "1e999", "", "x", "0.5x", "1,5", " 1", "1 "]:
                self.expect(USAGE, command, "sunflower", flag, value, "-o", "a.png",
                            message=f"{flag} must be in {limits}, got {value}")
        self.expect(USAGE, "grow", "sunflower", "--at", "7", "-o", "a.glb", message="--at must be in [0, 1], got 7")
        self.expect(USAGE, "grow", "sunflower", "--at=-0.1", "-o", "a.glb", message="--at must be in [0, 1], got -0.1")
        self.expect(USAGE, "grow", "sunflower", "--detail", "0", "-o", "a.glb",
                    message="--detail must be in (0, 8], got 0")

    def test_every_whole_number_is_checked_and_named(self):
        wholes = {
            ("grow", "--seed"): "[0, 18446744073709551615]",
            ("grow", "--threads"): "[0, 1024]",
            ("grow", "--frames"): "[1, 1000]",
            ("grow", "--collision-steps"): "[1, 10000]",
            ("render", "--collision-steps"): "[1, 10000]",
            ("render", "--frames"): "[1, 1000]",
            ("render", "--columns"): "[1, 100]",
            ("render", "--samples"): "[1, 4096]",
            ("render", "--size"): "[16, 8192]",
            ("pattern", "--vogel"): "[1, 1000000]",
        }
        for (command, flag), limits in wholes.items():
            for value in ["-1", "nan", "1.5", "18446744073709551616", "99999999999999999999999", "", "x", "3x", "+1"]:
                self.expect(USAGE, command, "sunflower", flag, value, "-o", "a.png",
                            message=f"{flag} must be a whole number in {limits}, got {value}")

    def test_words_are_checked_and_named(self):
        self.expect(USAGE, "render", "sunflower", "-o", "a.png", "--view", "up",
                    message="--view must be top, bottom, side, front or three-quarter, got up")
        self.expect(USAGE, "render", "sunflower", "-o", "a.png", "--quality", "best",
                    message="--quality must be draft or final, got best")
        self.expect(USAGE, "render", "sunflower", "-o", "a.png", "--backdrop", "red",
                    message="--backdrop must be light, dark or none, got red")
        self.expect(USAGE, "render", "sunflower", "-o", "a.png", "--size", "100x",
                    message="--size must be a whole number in [16, 8192], got 100x")

        self.expect(USAGE, "render", "sunflower", "-o", "a.png", "--organ", "ray",
                    message="--organ must be ray_floret, disk_floret or bract, got ray")

    def test_flags_that_do_not_go_together(self):
        self.expect(USAGE, "grow", "sunflower", "-o", "a.glb", "--at", "1", "--frames", "3",
                    message="--at is for one time and --frames for an animation: give one of them")
        self.expect(USAGE, "grow", "sunflower", "-o", "a.ply", "--frames", "3",
                    message="--frames needs a .glb or .pc2 output; `anthesis render` takes pictures of several times")
        self.expect(USAGE, "grow", "sunflower", "-o", "a.glb", "--resume",
                    message="--resume goes on from a --checkpoint: give its folder")
        for useless in [["grow", "sunflower", "-o", "a.glb", "--no-collisions"], ["grow", "sunflower", "-o", "a.csv"],
                        ["render", "sunflower", "-o", "a.png", "--organ", "bract"]]:
            self.expect(USAGE, *useless, "--checkpoint", "work",
                        message="--checkpoint is for the work on collisions, and this command does none")
        self.expect(USAGE, "pattern", "sunflower", "--vogel", "82",
                    message="a species, --measured, --study, and --vogel or --sweep each have their own pattern: "
                            "give one of them")
        self.expect(USAGE, "pattern", "--sweep", "cone-deg=20:89:1",
                    message="--sweep cone-deg needs the number of florets: --vogel N")

    def test_sweeps_are_checked(self):
        form = "--sweep must be cone-deg=FROM:TO:STEP or organs=FROM:TO:STEP, got "
        for sweep in ["cone", "cone-deg", "cone-deg=1:2", "angle=1:2:3", "=1:2:3", ":::"]:
            self.expect(USAGE, "pattern", "--vogel", "82", "--sweep", sweep, message=form + sweep)
        self.expect(USAGE, "pattern", "--vogel", "82", "--sweep", "cone-deg=0:89:1",
                    message="--sweep cone-deg must be in (0, 180), got 0")
        self.expect(USAGE, "pattern", "--vogel", "82", "--sweep", "cone-deg=89:20:1",
                    message="--sweep cone-deg must run upwards, got cone-deg=89:20:1")
        self.expect(USAGE, "pattern", "--vogel", "82", "--sweep", "cone-deg=1:2:0",
                    message="--sweep cone-deg step must be in [1e-06, 1e+06], got 0")
        self.expect(USAGE, "pattern", "--sweep", "organs=20.5:30:1",
                    message="--sweep organs must be whole numbers, got organs=20.5:30:1")
        self.expect(USAGE, "pattern", "--vogel", "82", "--sweep", "cone-deg=1:100:0.00001")


class Answers(ProgramTest):
    def test_json_says_what_was_made(self):
        result = self.expect(DONE, "grow", "sunflower", "-o", "a.glb", "-o", "a.csv", "--frames", "3", "--json",
                             "--no-collisions")
        self.assertEqual(result.err, "")
        self.assertEqual(result.out.count("\n"), 1)
        report = json.loads(result.out)
        for key in ["species", "seed", "version", "organs", "frames", "triangles", "crossings", "seconds", "outputs"]:
            self.assertIn(key, report)
        self.assertEqual((report["species"], report["seed"], report["frames"]), ("sunflower", 1, 3))
        self.assertIsNone(report["crossings"])
        self.assertEqual(report["organs"]["ray_floret"], 34)
        self.assertGreater(report["organs"]["disk_floret"], 300)
        self.assertGreater(report["triangles"], 10000)
        self.assertGreaterEqual(report["seconds"]["total"], report["seconds"]["glb"])
        for output in report["outputs"]:
            with open(self.path(output["path"]), "rb") as file:
                self.assertEqual(hashlib.sha256(file.read()).hexdigest(), output["sha256"])
        with open(self.path("a.csv"), encoding="utf-8") as file:
            rows = [line for line in file if not line.startswith("#")]
        self.assertEqual(len(rows) - 1, sum(report["organs"].values()))

    def test_seeds_are_individuals_of_one_species(self):
        for seed in [1, 2]:
            self.expect(DONE, "grow", "sunflower", "-o", f"{seed}.csv", "--seed", str(seed))
        self.expect(DONE, "grow", "sunflower", "-o", "default.csv")
        one, two, default = (self.content(f"{name}.csv") for name in ["1", "2", "default"])
        self.assertEqual(one, default)
        self.assertNotEqual(one, two)

    def test_pattern_writes_every_format(self):
        self.expect(DONE, "pattern", "sunflower", "-o", "a.csv", "-o", "a.svg", "-o", "a.ply", "--at", "0.5")
        with open(self.path("a.svg"), encoding="utf-8") as file:
            self.assertIn("<svg", file.read())
        with open(self.path("a.ply"), encoding="utf-8") as file:
            ply = file.read()
        count = int(re.search(r"element vertex (\d+)", ply).group(1))
        self.assertEqual(len(ply.split("end_header\n")[1].splitlines()), count)

    def test_cone_rule_counts_rays_on_a_disc(self):
        for cone, rays in [(25, 34), (60, 21), (80, 13)]:
            result = self.expect(DONE, "pattern", "--vogel", "82", "--cone-deg", str(cone))
            self.assertEqual(result.out, f"{rays} ray florets, {82 - rays} disk florets\n")

    def test_sweep_writes_a_table_and_a_plot(self):
        self.expect(DONE, "pattern", "--vogel", "82", "--sweep", "cone-deg=20:89:0.5", "-o", "a.csv", "-o", "a.svg")
        with open(self.path("a.csv"), encoding="utf-8") as file:
            lines = file.read().splitlines()
        self.assertEqual(lines[1], "cone_deg,ray_florets")
        self.assertEqual(lines[2], "20,34")
        self.assertEqual(lines[-1], "89,13")
        self.assertEqual(len(lines), 2 + 139)
        table = self.expect(DONE, "pattern", "--sweep", "organs=20:400:1").out
        self.assertEqual(table.splitlines()[-1].split(",")[1], "34")

    def test_species_lists_prints_and_checks(self):
        self.assertRegex(self.expect(DONE, "species").out, r"(?m)^sunflower +Helianthus annuus ")
        with open(os.path.join(SOURCE, "species", "sunflower.toml"), encoding="utf-8") as file:
            self.assertEqual(self.expect(DONE, "species", "sunflower").out, file.read())
        self.assertEqual(json.loads(self.expect(DONE, "species", "--schema").out)["type"], "object")
        path = os.path.join(SOURCE, "species", "sunflower.toml")
        self.assertEqual(self.expect(DONE, "species", path, "--check").out, f"{path}: no errors\n")
        names = [plant["name"] for plant in json.loads(self.expect(DONE, "species", "--json").out)["species"]]
        self.assertIn("sunflower", names)

    def test_a_species_file_grows_like_the_built_in_species(self):
        path = os.path.join(SOURCE, "species", "sunflower.toml")
        self.expect(DONE, "grow", path, "-o", "file.glb", "--no-collisions")
        self.expect(DONE, "grow", "sunflower", "-o", "name.glb", "--no-collisions")
        with open(self.path("file.glb"), "rb") as one, open(self.path("name.glb"), "rb") as other:
            self.assertEqual(one.read(), other.read())

    def test_render_writes_numbered_frames(self):
        self.expect(DONE, "render", scene("bud"), "-o", "a.png", "--frames", "3", "--size", "48x32", "--samples", "2",
                    "--quality", "draft")
        self.assertEqual(sorted(os.listdir(self.folder)), ["a_0000.png", "a_0001.png", "a_0002.png"])
        with open(self.path("a_0002.png"), "rb") as file:
            header = file.read(33)
        self.assertEqual(header[:8], b"\x89PNG\r\n\x1a\n")
        self.assertEqual((int.from_bytes(header[16:20], "big"), int.from_bytes(header[20:24], "big")), (48, 32))


class Terminal(ProgramTest):
    LONG = ["render", "sunflower", "--no-collisions", "-o", "a.png", "--size", "1600", "--samples", "512"]

    def test_progress_is_for_terminals_only(self):
        main_end, terminal = pty.openpty()
        process = subprocess.Popen([PROGRAM, *self.LONG], cwd=self.folder, stdout=subprocess.PIPE, stderr=terminal)
        os.close(terminal)
        shown = b""
        while b"%" not in shown:
            shown += os.read(main_end, 4096)
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.wait(timeout=60), INTERRUPTED)
        self.assertEqual(process.stdout.read(), b"")
        process.stdout.close()
        os.close(main_end)
        self.assertRegex(shown, rb"\r\x1b\[K[a-z]+.* \d+ %")

    def test_ctrl_c_stops_without_a_partial_file(self):
        process = subprocess.Popen([PROGRAM, *self.LONG], cwd=self.folder, stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE)
        time.sleep(1.0)
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=60)
        self.assertEqual((process.returncode, out, err), (INTERRUPTED, b"", b"anthesis: stopped\n"))
        self.assertEqual(os.listdir(self.folder), [])


if __name__ == "__main__":
    main()
