"""What the tests of the program share: running it, in a folder of its own, and looking at what it says."""
import os
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest
import zlib

PROGRAM = os.environ.get("ANTHESIS") or os.path.join(os.path.dirname(__file__), "..", "build", "bin", "anthesis")
PROGRAM = os.path.abspath(PROGRAM)
SOURCE = os.path.abspath(os.path.join(os.path.dirname(__file__), ".."))

DONE, CROSSINGS, USAGE, BAD_DATA, IO_FAILED, INTERRUPTED = 0, 1, 2, 65, 74, 130
SKIPPED = 77  # tells ctest that a test could not be made here


def scene(name):
    """The file of a small plant."""
    return os.path.join(SOURCE, "scenes", name + ".toml")


class Result:
    def __init__(self, status, out, err):
        self.status, self.out, self.err = status, out, err


class ProgramTest(unittest.TestCase):
    """Each test works in an empty folder."""

    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="anthesis-")
        self.addCleanup(shutil.rmtree, self.folder)

    def path(self, name):
        return os.path.join(self.folder, name)

    def content(self, name):
        with open(self.path(name), "rb") as file:
            return file.read()

    def coverage(self, name):
        """Rows of the alpha channel of a PNG of four channels of 8 bits."""
        content = self.content(name)
        width, height, depth, kind = struct.unpack_from(">IIBB", content, 16)
        self.assertEqual((depth, kind), (8, 6))
        data, place = b"", 8
        while place < len(content):
            size, = struct.unpack_from(">I", content, place)
            if content[place + 4:place + 8] == b"IDAT":
                data += content[place + 8:place + 8 + size]
            place += 12 + size
        data = zlib.decompress(data)
        stride = 4 * width
        rows, above = [], [0] * stride
        for y in range(height):
            kind, *row = data[y * (stride + 1):(y + 1) * (stride + 1)]
            for x in range(stride):
                left, corner = (row[x - 4], above[x - 4]) if x >= 4 else (0, 0)
                nearest = min((left, above[x], corner), key=lambda v: abs(left + above[x] - corner - v))
                row[x] = (row[x] + [0, left, above[x], (left + above[x]) // 2, nearest][kind]) & 255
            rows.append(row[3::4])
            above = row
        return rows

    def run_program(self, *arguments, environment=None, timeout=120, preexec=None):
        process = subprocess.run([PROGRAM, *arguments], cwd=self.folder, capture_output=True, timeout=timeout,
                                 env={**os.environ, **(environment or {})}, preexec_fn=preexec, check=False)
        return Result(process.returncode, process.stdout.decode("utf-8", "replace"),
                      process.stderr.decode("utf-8", "replace"))

    def expect(self, status, *arguments, message=None, **options):
        """Runs the program and checks its exit status; a refusal is one line that says why, and leaves no file."""
        before = set(os.listdir(self.folder))
        result = self.run_program(*arguments, **options)
        self.assertEqual(result.status, status, f"{arguments}: {result.err}")
        if status != DONE:
            self.assertEqual(result.out, "", arguments)
            self.assertEqual(result.err.count("\n"), 1, result.err)
            self.assertTrue(result.err.startswith("anthesis: "), result.err)
            self.assertEqual(set(os.listdir(self.folder)), before, f"{arguments} left files behind")
        if message is not None:
            self.assertEqual(result.err, f"anthesis: {message}\n")
        return result


def main():
    if not os.access(PROGRAM, os.X_OK):
        sys.exit(f"no program at {PROGRAM}; build it, or say where it is: ANTHESIS=...")
    unittest.main(verbosity=1)


def skip(why):
    print(f"skipped: {why}")
    sys.exit(SKIPPED)
