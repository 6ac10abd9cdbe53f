"""Species files that are not: one clear error each, with its place, in bounded time and memory."""
import os
import re
import resource

from program import BAD_DATA, DONE, IO_FAILED, SOURCE, ProgramTest, main

with open(os.path.join(SOURCE, "species", "sunflower.toml"), "rb") as sunflower:
    SUNFLOWER = sunflower.read()


class SpeciesFiles(ProgramTest):
    def refused(self, content, status=BAD_DATA):
        """The one line about a species file with this content."""
        with open(self.path("mine.toml"), "wb") as file:
            file.write(content)
        result = self.expect(status, "grow", "mine.toml", "-o", "a.glb", timeout=20)
        self.assertTrue(result.err.startswith("anthesis: mine.toml:"), result.err)
        self.assertLess(len(result.err), 500)
        return result.err[len("anthesis: "):-1]

    def replaced(self, old, new):
        self.assertIn(old, SUNFLOWER)
        return self.refused(SUNFLOWER.replace(old, new, 1))

    def line_of(self, text):
        return SUNFLOWER[:SUNFLOWER.index(text)].count(b"\n") + 1

    def test_truncated(self):
        step = max(len(SUNFLOWER) // 60, 1)
        for size in range(0, len(SUNFLOWER) - 200, step):
            self.refused(SUNFLOWER[:size])

    def test_empty_and_blank(self):
        for content in [b"", b"\n\n\n", b"# nothing\n"]:
            self.assertEqual(self.refused(content), "mine.toml:1:1: name is missing")

    def test_binary(self):
        for content in [bytes(range(256)) * 16, b"\0" * 4096, b"glTF\2\0\0\0" * 100, b"\xff\xfe" * 1000,
                        b"\x89PNG\r\n\x1a\n" * 100, os.urandom(4096)]:
            self.assertIn("is not TOML", self.refused(content))

    def test_hundred_megabytes(self):
        with open(self.path("mine.toml"), "wb") as file:
            file.truncate(100_000_000)

        def little_memory():
            resource.setrlimit(resource.RLIMIT_AS, (2 << 30, 2 << 30))

        self.expect(BAD_DATA, "species", "mine.toml", "--check", timeout=10, message=(
            "mine.toml: must be at most 1048576 bytes, got 100000000"),
            preexec=None if "sanitize" in os.environ.get("ANTHESIS_BUILD", "") else little_memory)

    def test_endless(self):
        self.expect(BAD_DATA, "species", "/dev/zero", "--check", timeout=10,
                    message="/dev/zero: must be at most 1048576 bytes")

    def test_deeply_nested(self):
        for content in [b"name = " + b"[" * 100_000, b"name = " + b"{a=" * 100_000, b"[" + b"a." * 100_000 + b"a]",
                        b"a." * 500_000 + b"a = 1", b"[" * 100_000, b"name = [" * 50_000]:
            self.assertRegex(self.refused(content), r"^mine\.toml:1:\d+: (nests more than|has a key of more than|is not)")

    def test_misspelt(self):
        line = self.line_of(b"divergence_deg")
        self.assertEqual(self.replaced(b"divergence_deg", b"divergance_deg"),
                         f"mine.toml:{line}:1: head.divergance_deg is not known; did you mean divergence_deg?")
        line = self.line_of(b"[head]")
        self.assertEqual(self.replaced(b"[head]", b"[haed]").split(": ", 1)[0], f"mine.toml:{line}:2")
        line = self.line_of(b'organ = "disk_floret"')
        self.assertEqual(self.replaced(b'organ = "disk_floret"', b'organ = "disc_floret"'),
                         f"mine.toml:{line}:9: head.zones[0].organ must name one of the organs, got \"disc_floret\"; "
                         'did you mean "disk_floret"?')

    def test_numbers_that_make_no_plant(self):
        line = self.line_of(b"interval = ")
        old = SUNFLOWER.splitlines()[line - 1]
        for value in ["nan", "-nan", "inf", "-inf", "-0.4", "0", "1e300", "99999999999"]:
            message = self.replaced(old, b"interval = " + value.encode())
            self.assertTrue(message.startswith(
                f"mine.toml:{line}:12: head.interval must be > 0 and at most 1, got "), message)
        self.assertIn(f"mine.toml:{line}:", self.replaced(old, b"interval = 1e999"))

    def test_every_number_key_of_the_head_refuses_what_is_not_a_number(self):
        for key in [b"divergence_deg", b"interval", b"meristem_area_mm2", b"cone_deg"]:
            line = self.line_of(key)
            old = SUNFLOWER.splitlines()[line - 1]
            for value in [b"nan", b"inf", b"-inf", b"1e300", b'"x"', b"[1]", b"true", b"1979-05-27"]:
                message = self.replaced(old, key + b" = " + value)
                self.assertIn(f"mine.toml:{line}:", message)
                self.assertIn(key.decode() + " must be ", message)

    def test_a_plant_with_too_many_organs_is_refused(self):
        line = self.line_of(b"interval = ")
        old = SUNFLOWER.splitlines()[line - 1]
        with open(self.path("mine.toml"), "wb") as file:
            file.write(SUNFLOWER.replace(old, b"interval = 0.000001", 1).replace(b"[0.0, 6.0]", b"[0.0, 0.000001]", 1))
        result = self.run_program("grow", "mine.toml", "-o", "a.csv", timeout=60)
        self.assertIn(result.status, [DONE, BAD_DATA], result.err)

    def test_the_manuals_examples_make_a_plant(self):
        with open(os.path.join(SOURCE, "docs", "species-files.md"), encoding="utf-8") as file:
            blocks = re.findall(r"```toml\n(.*?)```", file.read(), re.S)
        rest = """
            [organs.disk_floret]
            [[organs.disk_floret.columns]]
            name = "tube"
            pigment = "green"
            [[organs.disk_floret.columns.poses]]
            stage = 0.0
            profile_mm = [[0.2, 0.0], [0.3, 1.0], [0.3, 2.0], [0.0, 3.0]]
            [organs.bract]
            [[organs.bract.petals]]
            name = "blade"
            pigment = "green"
            [[organs.bract.petals.poses]]
            stage = 0.0
            midrib_mm = [[0, 0], [0, 1], [0, 2], [0, 3]]
            half_width_mm = [1, 1, 1, 0]
            [pigments.green]
            colour = "#3a6b22"
            [pigments.hair]
            colour = "#d8dcc0"
            """
        with open(self.path("mine.toml"), "w", encoding="utf-8") as file:
            file.write("".join(blocks) + rest)
        self.expect(DONE, "grow", "mine.toml", "-o", "a.glb", "--no-collisions")
        # Printed in canonical form it is the same plant.
        canonical = self.expect(DONE, "species", "mine.toml").out
        with open(self.path("canonical.toml"), "w", encoding="utf-8") as file:
            file.write(canonical)
        self.assertEqual(self.expect(DONE, "species", "canonical.toml").out, canonical)

    def test_missing_and_unreadable(self):
        self.expect(IO_FAILED, "grow", "nowhere.toml", "-o", "a.glb",
                    message="nowhere.toml: cannot open: No such file or directory")
        self.expect(IO_FAILED, "grow", "./", "-o", "a.glb", message="./: cannot read: Is a directory")


if __name__ == "__main__":
    main()
