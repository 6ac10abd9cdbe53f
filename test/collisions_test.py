"""Organs that keep out of each other's way: no crossing in what is written, whatever interrupts the work."""
import json
import os
import random
import signal
import struct
import subprocess
import time

from program import CROSSINGS, DONE, INTERRUPTED, PROGRAM, USAGE, ProgramTest, main, scene


class CollisionsTest(ProgramTest):
    def expect_same(self, one, other, same=True):
        """Of long values, whose differences no one wants to read."""
        self.assertTrue((one == other) == same, "differ" if same else "are the same")


class Certificate(CollisionsTest):
    def test_no_triangle_crosses_another_in_any_frame(self):
        for name in ["two_petals", "bud"]:
            report = json.loads(self.expect(DONE, "grow", scene(name), "-o", "a.glb", "-o", "a.ply", "--json").out)
            self.assertEqual((report["crossings"], report["frames"]), (0, 25))
            self.assertGreater(report["collisions"]["contacts"], 0)
            for file, frames in [("a.glb", 25), ("a.ply", 1)]:
                found = json.loads(self.expect(DONE, "check", file, "--json").out)
                self.assertEqual((found["crossings"], found["degenerate"], found["frames"], found["triangles"]),
                                 (0, 0, frames, report["triangles"]), f"{name} {file}")

    def test_left_to_themselves_the_same_organs_cross(self):
        for name in ["two_petals", "bud"]:
            report = json.loads(self.expect(DONE, "grow", scene(name), "-o", "a.glb", "-o", "a.ply", "--json",
                                            "--no-collisions").out)
            self.assertIsNone(report["crossings"])
            self.assertNotIn("collisions", report)
            result = self.run_program("check", "a.glb", "--json")
            self.assertEqual(result.status, CROSSINGS)
            self.assertGreater(json.loads(result.out)["crossings"], 10)

    def test_so_do_those_of_every_plant(self):
        for name, many in [("sunflower", 1000), ("dahlia", 500), ("daisy", 100), ("gaillardia", 100)]:
            # Gaillardia's organs crowd in the bud, those of the others in the bloom.
            time_shown = "0.4" if name == "gaillardia" else "1"
            self.expect(DONE, "grow", name, "-o", "a.ply", "--at", time_shown, "--no-collisions")
            found = json.loads(self.run_program("check", "a.ply", "--json").out)
            self.assertGreater(found["crossings"], many, name)

    def test_a_table_shows_no_surfaces_and_needs_no_certificate(self):
        report = json.loads(self.expect(DONE, "grow", "sunflower", "-o", "a.csv", "--json").out)
        self.assertIsNone(report["crossings"])


class Frames(CollisionsTest):
    def vertices(self, name):
        with open(self.path(name), encoding="utf-8") as file:
            return [tuple(map(float, line.split()[1:])) for line in file if line.startswith("v ")]

    def samples(self, name):
        """The samples of a point cache: tuples of three numbers, as they are in the file."""
        content = self.content(name)
        magic, version, points, _, _, count = struct.unpack_from("<12siiffi", content)
        self.assertEqual((magic, version), (b"POINTCACHE2\0", 1))
        size = 12 * points
        self.assertEqual(len(content), 32 + count * size)
        return [content[32 + i * size:32 + (i + 1) * size] for i in range(count)]

    def test_the_frame_rate_changes_no_frame(self):
        self.expect(DONE, "grow", scene("bud"), "-o", "three.pc2", "--frames", "3")
        self.expect(DONE, "grow", scene("bud"), "-o", "five.pc2", "--frames", "5")
        # 8 frames fall between the steps of growth, but for the first and the last.
        self.expect(DONE, "grow", scene("bud"), "-o", "eight.pc2", "--frames", "8")
        three, five, eight = (self.samples(f"{name}.pc2") for name in ["three", "five", "eight"])
        self.assertEqual((len(three), len(five), len(eight)), (3, 5, 8))
        self.expect_same(three, five[::2])
        self.expect_same((eight[0], eight[-1]), (three[0], three[-1]))
        self.assertEqual(len(set(eight)), 8)

    def test_one_time_alone_is_the_frame_of_a_series(self):
        self.expect(DONE, "grow", scene("bud"), "-o", "still.ply", "--at", "0.5")
        self.expect(DONE, "grow", scene("bud"), "-o", "still.obj", "-o", "alone.ply", "--at", "0.5",
                    "--collision-steps", "96")
        self.expect_same(self.content("still.ply"), self.content("alone.ply"))
        self.expect(DONE, "grow", scene("bud"), "-o", "series.pc2", "--frames", "3")
        middle = self.samples("series.pc2")[1]
        still = self.vertices("still.obj")
        born = {struct.pack("<3f", *vertex) for vertex in still}
        series = {middle[i:i + 12] for i in range(0, len(middle), 12)}
        self.assertGreater(len(born), 1000)
        self.assertTrue(born <= series)

    def test_a_point_cache_ends_where_its_obj_stands(self):
        self.expect(DONE, "grow", scene("two_petals"), "-o", "a.pc2", "--frames", "4")
        self.assertEqual(sorted(os.listdir(self.folder)), ["a.mtl", "a.obj", "a.pc2"])
        self.expect_same(self.samples("a.pc2")[-1],
                         b"".join(struct.pack("<3f", *vertex) for vertex in self.vertices("a.obj")))

    def test_more_steps_are_another_way_to_the_flower(self):
        self.expect(DONE, "grow", scene("bud"), "-o", "a.ply", "-o", "a.obj")
        self.expect(DONE, "grow", scene("bud"), "-o", "b.ply", "-o", "b.obj", "--collision-steps", "48")
        self.expect(DONE, "check", "b.ply")
        self.expect_same(self.vertices("a.obj"), self.vertices("b.obj"), same=False)

    def test_threads_change_nothing(self):
        for threads in ["1", "2"]:
            self.expect(DONE, "grow", scene("bud"), "-o", f"{threads}.glb", "--threads", threads)
        self.expect_same(self.content("1.glb"), self.content("2.glb"))


class Pictures(CollisionsTest):
    SMALL = ["--size", "48", "--quality", "draft"]

    def test_a_picture_shows_the_organs_apart(self):
        report = json.loads(self.expect(DONE, "render", scene("bud"), "-o", "a.png", *self.SMALL, "--json").out)
        self.assertEqual(report["crossings"], 0)
        self.expect(DONE, "render", scene("bud"), "-o", "b.png", *self.SMALL, "--no-collisions")
        self.assertEqual([b"Collisions" in self.content(name) for name in ["a.png", "b.png"]], [True, False])
        self.expect_same(self.content("a.png"), self.content("b.png"), same=False)

    def test_pictures_of_a_series_are_pictures_of_their_times(self):
        # Two petals are nowhere larger than at the end, so that the camera stands where it stands for that alone.
        self.expect(DONE, "render", scene("two_petals"), "-o", "a.png", *self.SMALL, "--frames", "3")
        self.expect(DONE, "render", scene("two_petals"), "-o", "last.png", *self.SMALL)
        self.expect_same(self.content("a_0002.png"), self.content("last.png"))

    def test_a_flower_that_is_taller_while_it_opens_is_not_cut_off(self):
        self.expect(DONE, "render", scene("bud"), "-o", "a.png", *self.SMALL, "--frames", "6", "--backdrop", "none")
        for frame in range(6):
            coverage = self.coverage(f"a_{frame:04d}.png")
            self.assertTrue(any(map(any, coverage)))
            self.assertFalse(any(coverage[0]), f"frame {frame} touches the upper border")
            self.assertFalse(any(row[0] or row[-1] for row in coverage), f"frame {frame} touches a side")


class Interruptions(CollisionsTest):
    COMMAND = ["grow", scene("bud"), "-o", "a.glb", "--collision-steps", "200", "--checkpoint", "work"]

    def start(self, *flags):
        return subprocess.Popen([PROGRAM, *self.COMMAND, *flags], cwd=self.folder, stdout=subprocess.PIPE,
                                stderr=subprocess.PIPE)

    def whole(self):
        """The file of a run that nothing interrupts."""
        began = time.monotonic()
        self.expect(DONE, *self.COMMAND)
        took = time.monotonic() - began
        self.assertEqual(os.listdir(self.folder), ["a.glb"])  # the checkpoint is gone
        content = self.content("a.glb")
        os.unlink(self.path("a.glb"))
        return content, took

    def test_killed_at_any_moment_the_work_goes_on(self):
        whole, took = self.whole()
        moments = random.Random(1)
        all_kills = 0
        while all_kills < 20:
            kills = 0
            process = self.start()
            while True:
                patience = 1.0 + 0.1 * kills  # a busy machine needs longer to start than it took alone
                try:
                    process.wait(timeout=moments.uniform(0.05, 0.25) * took * patience)
                    break
                except subprocess.TimeoutExpired:
                    process.kill()
                    process.communicate()
                kills += 1
                if os.path.exists(self.path("a.glb")):  # killed while it cleaned up
                    self.expect_same(self.content("a.glb"), whole)
                self.assertLess(kills, 200)
                process = self.start("--resume")
            self.assertEqual((*process.communicate(), process.returncode), (b"", b"", DONE))
            self.assertGreater(kills, 1)
            all_kills += kills
            self.expect_same(self.content("a.glb"), whole)
            # Nothing of it is left to be taken up again.
            self.expect(DONE, *self.COMMAND)
            self.expect_same(self.content("a.glb"), whole)
            os.unlink(self.path("a.glb"))

    def test_ctrl_c_keeps_the_work(self):
        whole, _ = self.whole()
        process = self.start()
        while not os.path.exists(self.path("work/state.checkpoint")):
            time.sleep(0.01)
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.communicate(timeout=60),
                         (b"", b"anthesis: stopped; the same command with --resume goes on\n"))
        self.assertEqual(process.returncode, INTERRUPTED)
        self.assertEqual(os.listdir(self.folder), ["work"])
        self.expect(USAGE, *self.COMMAND,
                    message="--checkpoint must be a folder without a run in it, or be resumed, got work")
        self.expect(DONE, *self.COMMAND, "--resume")
        self.expect_same(self.content("a.glb"), whole)
        self.assertEqual(os.listdir(self.folder), ["a.glb"])

    def test_resuming_nothing_starts_afresh(self):
        self.expect(DONE, "grow", scene("two_petals"), "-o", "a.ply")
        plain = self.content("a.ply")
        self.expect(DONE, "grow", scene("two_petals"), "-o", "a.ply", "--checkpoint", "work", "--resume")
        self.expect_same(self.content("a.ply"), plain)
        os.mkdir(self.path("empty"))
        self.expect(DONE, "grow", scene("two_petals"), "-o", "a.ply", "--checkpoint", "empty", "--resume")
        self.expect_same(self.content("a.ply"), plain)


if __name__ == "__main__":
    main()
