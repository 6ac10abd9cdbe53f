"""Same species, seed and version: same bytes, whatever the number of threads and the processor's instructions."""
import os
import subprocess

from program import DONE, PROGRAM, ProgramTest, main, scene

# File name: the command that writes it.
FILES = {
    "a.glb": ["grow", "sunflower", "--frames", "5", "--no-collisions"],
    "bent.glb": ["grow", scene("bud"), "--frames", "5"],
    "a.ply": ["grow", "sunflower", "--at", "0.7", "--no-collisions"],
    "bent.ply": ["grow", scene("pinwheel"), "--at", "0.7"],
    "a.csv": ["grow", "sunflower", "--at", "0.7"],
    "a.svg": ["pattern", "sunflower"],
    "a.png": ["render", scene("bud"), "--size", "96", "--quality", "draft"],
}
NO_FMA = {"GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2_Usable,-FMA_Usable"}


class SameBytes(ProgramTest):
    def files(self, *flags, environment=None):
        contents = {}
        for name, command in FILES.items():
            self.expect(DONE, *command, "-o", name, *flags, environment=environment)
            with open(self.path(name), "rb") as file:
                contents[name] = file.read()
        return contents

    def expect_equal(self, one, other):
        for name in FILES:
            self.assertTrue(one[name] == other[name], f"{name} differs")

    def test_with_one_two_and_three_threads(self):
        one = self.files("--threads", "1")
        for threads in ["2", "3", "0"]:
            self.expect_equal(one, self.files("--threads", threads))

    def test_without_fused_multiply_add(self):
        self.expect_equal(self.files(), self.files(environment=NO_FMA))

    def test_anywhere_in_memory(self):
        plain = self.files()
        for name, command in FILES.items():
            os.unlink(self.path(name))
            process = subprocess.run(["setarch", "-R", PROGRAM, *command, "-o", name], cwd=self.folder,
                                     capture_output=True, check=False)
            if process.returncode != DONE and b"setarch" in process.stderr:
                self.skipTest("setarch -R is not allowed here")
            with open(self.path(name), "rb") as file:
                self.assertTrue(file.read() == plain[name], f"{name} differs")


if __name__ == "__main__":
    main()
