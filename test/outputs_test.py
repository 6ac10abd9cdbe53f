"""Outputs appear whole or not at all: full disks, folders that are missing or closed, devices."""
import os
import resource
import subprocess

from program import DONE, IO_FAILED, PROGRAM, ProgramTest, main, scene

# A command for each way to write, with the format it writes.
WRITERS = [
    (["grow", "sunflower", "--no-collisions"], "glb"),
    (["grow", "sunflower", "--no-collisions"], "obj"),
    (["grow", "sunflower", "--no-collisions"], "ply"),
    (["grow", scene("two_petals"), "--frames", "2"], "pc2"),
    (["grow", "sunflower", "--no-collisions"], "csv"),
    (["pattern", "sunflower"], "svg"),
    (["pattern", "sunflower"], "ply"),
    (["pattern", "--vogel", "5000"], "csv"),
    (["render", "sunflower", "--no-collisions", "--size", "100", "--samples", "1"], "png"),
]


class Outputs(ProgramTest):
    def test_full_disk(self):
        for command, _ in WRITERS:
            self.expect(IO_FAILED, *command, "-o", "/dev/full",
                        message="/dev/full: cannot write: No space left on device")

    def test_full_disk_behind_a_file_name(self):
        for command, extension in WRITERS:
            if extension == "obj":
                continue  # its material library is a second, real file
            os.symlink("/dev/full", self.path(f"a.{extension}"))
            self.expect(IO_FAILED, *command, "-o", f"a.{extension}",
                        message=f"a.{extension}: cannot write: No space left on device")
            os.unlink(self.path(f"a.{extension}"))

    def test_disk_that_fills_up_while_writing(self):
        limit = 4096  # bytes that a file may have, as `ulimit -f` says it

        def small_disk():
            resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))

        for command, extension in WRITERS:
            if extension in ["obj", "pc2"]:
                continue  # the material library fits, and is whole
            self.expect(IO_FAILED, *command, "-o", f"a.{extension}", preexec=small_disk,
                        message=f"a.{extension}: cannot write: File too large")

    def test_an_older_file_survives_a_failed_write(self):
        with open(self.path("a.glb"), "wb") as file:
            file.write(b"precious")

        def small_disk():
            resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))

        self.expect(IO_FAILED, "grow", "sunflower", "--no-collisions", "-o", "a.glb", preexec=small_disk)
        with open(self.path("a.glb"), "rb") as file:
            self.assertEqual(file.read(), b"precious")

    def test_folder_that_is_missing(self):
        for command, extension in WRITERS:
            self.expect(IO_FAILED, *command, "-o", f"missing/a.{extension}",
                        message=f"missing/a.{extension}: cannot write: No such file or directory")

    def test_folder_that_is_a_file(self):
        with open(self.path("file"), "wb"):
            pass
        for command, extension in WRITERS:
            self.expect(IO_FAILED, *command, "-o", f"file/a.{extension}",
                        message=f"file/a.{extension}: cannot write: Not a directory")

    def test_folder_that_is_read_only(self):
        closed = self.path("closed")
        os.mkdir(closed, 0o555)
        if os.access(closed, os.W_OK):  # root writes anywhere but here
            closed = "/proc/self"
            if os.access(closed, os.W_OK):
                closed = "/sys/kernel"
        for command, extension in WRITERS:
            result = self.expect(IO_FAILED, *command, "-o", f"{closed}/a.{extension}")
            self.assertIn(f"{closed}/a.{extension}: cannot write: ", result.err)

    def test_path_that_is_a_folder(self):
        os.mkdir(self.path("a.glb"))
        self.expect(IO_FAILED, "grow", "sunflower", "-o", "a.glb", message="a.glb: cannot write: Is a directory")

    def test_outputs_are_checked_before_the_work(self):
        # Half an hour of work would follow.
        self.expect(IO_FAILED, "render", "sunflower", "-o", "missing/a.png", "--size", "8192", "--samples", "4096",
                    timeout=20)

    def test_one_closed_output_stops_all(self):
        self.expect(IO_FAILED, "grow", "sunflower", "-o", "a.glb", "-o", "missing/a.csv")

    def test_devices_take_the_first_format(self):
        result = subprocess.run([PROGRAM, "grow", scene("two_petals"), "-o", "/dev/stdout"], capture_output=True, check=True)
        self.assertEqual(result.stdout[:4], b"glTF")

    def test_standard_output_that_is_full(self):
        for command in [["species"], ["species", "--schema"], ["--help"], ["pattern", "--vogel", "82"]]:
            with open("/dev/full", "wb") as full:
                process = subprocess.run([PROGRAM, *command], stdout=full, stderr=subprocess.PIPE, check=False)
            self.assertEqual(process.returncode, IO_FAILED)
            self.assertEqual(process.stderr, b"anthesis: standard output: cannot write: No space left on device\n")

    def test_the_same_command_again_replaces_the_file(self):
        for seed in ["1", "2"]:
            self.expect(DONE, "grow", "sunflower", "--seed", seed, "-o", "a.csv")
        with open(self.path("a.csv"), encoding="utf-8") as file:
            self.assertIn("# seed: 2", file.read())
        self.assertEqual(os.listdir(self.folder), ["a.csv"])


if __name__ == "__main__":
    main()
