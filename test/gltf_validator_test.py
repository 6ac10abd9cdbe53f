"""The Khronos glTF validator finds no error and no warning in what the program writes."""
import json
import os
import shutil
import subprocess

from program import DONE, SOURCE, ProgramTest, main, scene, skip

JUDGES = os.path.join(SOURCE, "test", "judges")


class GltfValidator(ProgramTest):
    def test_every_species_animated_and_still(self):
        names = [plant["name"] for plant in json.loads(self.expect(DONE, "species", "--json").out)["species"]]
        files = []
        every_kind = {"animated": [], "still": ["--at", "0.8"], "bud": ["--at", "0"], "fine": ["--detail", "2"],
                      "translucent": ["--diffuse-transmission", "--frames", "2"]}
        thorough = ["sunflower", "daisy", "dahlia", "gaillardia", "goatsbeard"]  # the others have up to 24,000 organs
        for name in names:
            for kind, flags in (every_kind if name in thorough else {"still": ["--at", "0.8"]}).items():
                files.append(self.path(f"{name}-{kind}.glb"))
                self.expect(DONE, "grow", name, "-o", files[-1], "--no-collisions", *flags)
        for name in ["two_petals", "bud", "pinwheel"]:  # organs bent by touching
            for kind, flags in {"animated": [], "still": ["--at", "0.8"], "start": ["--at", "0"],
                                "translucent": ["--diffuse-transmission", "--frames", "2"]}.items():
                files.append(self.path(f"{name}-{kind}.glb"))
                self.expect(DONE, "grow", scene(name), "-o", files[-1], *flags)
        files.append(self.path("veins.glb"))
        self.expect(DONE, "vasculature", scene("cap_head"), "-o", files[-1])
        files.append(self.path("veins-growing.glb"))
        self.expect(DONE, "vasculature", scene("cap_head"), "-o", files[-1], "--frames", "4")
        process = subprocess.run(["node", os.path.join(JUDGES, "validate.mjs"), *files], capture_output=True, text=True,
                                 check=False)
        print(process.stdout)
        self.assertEqual(process.returncode, 0, process.stdout + process.stderr)
        self.assertEqual(process.stdout.count("0 errors, 0 warnings"), len(files))


if __name__ == "__main__":
    if not shutil.which("node"):
        skip("no node (package nodejs)")
    if not os.path.isdir(os.path.join(JUDGES, "node_modules", "gltf-validator")):
        skip("no gltf-validator: ./dev setup installs it")
    main()
