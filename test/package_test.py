"""The installed package serves a program of its own: find_package(anthesis), then a pattern and a flower."""
import os
import re
import subprocess

from program import ProgramTest, SOURCE, main

BUILD = os.environ.get("ANTHESIS_BUILD", os.path.join(SOURCE, "build"))


class Package(ProgramTest):
    def call(self, *command):
        process = subprocess.run(command, cwd=self.folder, capture_output=True, text=True, check=False)
        self.assertEqual(process.returncode, 0, process.stdout + process.stderr)
        return process.stdout

    def cached(self, name):
        with open(os.path.join(BUILD, "CMakeCache.txt"), encoding="utf-8") as file:
            found = re.search(rf"^{name}:\w+=(.*)$", file.read(), re.M)
        return found.group(1) if found else ""

    def test_a_consumer_builds_and_runs(self):
        prefix = self.path("prefix")
        self.call("cmake", "--install", BUILD, "--prefix", prefix)
        flags = "-fsanitize=address,undefined" if self.cached("ANTHESIS_SANITIZE") == "ON" else ""
        self.call("cmake", "-S", os.path.join(SOURCE, "test", "consumer"), "-B", "consumer", "-G", "Ninja",
                  f"-DCMAKE_PREFIX_PATH={prefix}", f"-DCMAKE_CXX_FLAGS={flags}")
        self.call("cmake", "--build", "consumer")
        out = self.call(self.path("consumer/consumer"))
        self.assertRegex(out, r"^34 rays on the disc\n\d{3,} organs, \d{6,} bytes\n$")
        self.assertTrue(os.path.exists(self.path("sunflower.glb")))

        # The installed program, species files and schema.
        self.assertIn("anthesis ", self.call(os.path.join(prefix, "bin", "anthesis"), "--version"))
        species = os.path.join(prefix, "share", "anthesis", "species")
        self.assertIn("sunflower.toml", os.listdir(species))
        self.assertIn("species.schema.json", os.listdir(species))

        # Nothing that is installed remembers where it was built.
        for folder, _, names in os.walk(prefix):
            for name in names:
                if name.endswith((".cmake", ".h")):
                    with open(os.path.join(folder, name), encoding="utf-8") as file:
                        self.assertNotIn(SOURCE, file.read(), name)


if __name__ == "__main__":
    main()
