"""Same bytes where the comma is the decimal point: LC_ALL=de_DE.UTF-8, made for the test if the machine lacks it."""
import os
import shutil
import subprocess
import tempfile

from program import DONE, SOURCE, ProgramTest, main, skip
from same_bytes_test import FILES

LOCALES = tempfile.mkdtemp(prefix="anthesis-locale-")


class GermanLocale(ProgramTest):
    def test_files_and_messages_are_the_same(self):
        german = {"LC_ALL": "de_DE.UTF-8", "LOCPATH": LOCALES, "LANG": "de_DE.UTF-8"}
        for name, command in FILES.items():
            contents = []
            for environment in [{"LC_ALL": "C"}, german]:
                self.expect(DONE, *command, "-o", name, environment=environment)
                with open(self.path(name), "rb") as file:
                    contents.append(file.read())
            self.assertTrue(contents[0] == contents[1], f"{name} differs")
        self.assertEqual(self.expect(DONE, "species", "--schema", environment=german).out,
                         self.expect(DONE, "species", "--schema").out)
        self.expect(DONE, "species", os.path.join(SOURCE, "species", "sunflower.toml"), "--check", environment=german)


if __name__ == "__main__":
    try:
        made = shutil.which("localedef") and subprocess.run(
            ["localedef", "-i", "de_DE", "-f", "UTF-8", os.path.join(LOCALES, "de_DE.UTF-8")],
            capture_output=True, check=False).returncode == 0
        shown = made and subprocess.run(["locale", "decimal_point"], capture_output=True, check=False, env={
            **os.environ, "LC_ALL": "de_DE.UTF-8", "LOCPATH": LOCALES}).stdout
        if not made:
            skip("localedef cannot make de_DE.UTF-8 (package locales)")
        assert shown == b",\n", f"the locale is not in force: {shown}"
        main()
    finally:
        shutil.rmtree(LOCALES)
