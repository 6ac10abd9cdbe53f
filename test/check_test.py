"""anthesis check: files whose triangles cross, files whose triangles do not, files that are none."""
import json
import struct

from program import BAD_DATA, CROSSINGS, DONE, IO_FAILED, USAGE, ProgramTest, main

PLY = """ply
format ascii 1.0
comment kind 0: ray_floret
comment kind 1: bract
element vertex 6
property float x
property float y
property float z
property int organ
property int kind
element face 2
property list uchar int vertex_indices
end_header
0 0 0 12 0
4 0 0 12 0
0 4 0 12 0
1 1 {bottom} 7 1
1 1 2 7 1
1.5 1 2 7 1
3 0 1 2
3 3 4 5
"""


def glb():
    """Two triangles, one of which comes down through the other at the second of three keys and goes back."""
    floats = [0, 0, 0, 4, 0, 0, 0, 4, 0, 1, 1, 1, 1, 1, 2, 2, 1, 2]  # two triangles
    floats += [0, 1, 2]  # times
    floats += [0, 0, 0, 0, 0, -1.5, 0, 0, 0]  # translations
    binary = struct.pack(f"<{len(floats)}f", *floats)

    def accessor(first, count, kind):
        return {"bufferView": 0, "byteOffset": 4 * first, "componentType": 5126, "count": count, "type": kind}

    document = {
        "asset": {"version": "2.0"},
        "buffers": [{"byteLength": len(binary)}],
        "bufferViews": [{"buffer": 0, "byteLength": len(binary)}],
        "accessors": [accessor(0, 3, "VEC3"), accessor(9, 3, "VEC3"), accessor(18, 3, "SCALAR"),
                      accessor(21, 3, "VEC3")],
        "meshes": [{"primitives": [{"attributes": {"POSITION": i}}]} for i in range(2)],
        "nodes": [{"children": [1, 2], "scale": [0.001, 0.001, 0.001]}, {"name": "petal.1", "mesh": 0},
                  {"name": "petal.2", "mesh": 1}],
        "scenes": [{"nodes": [0]}],
        "animations": [{"samplers": [{"input": 2, "output": 3}],
                        "channels": [{"sampler": 0, "target": {"node": 2, "path": "translation"}}]}],
    }
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(binary), b"BIN\0") + binary
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


class Check(ProgramTest):
    def write(self, name, content):
        with open(self.path(name), "wb") as file:
            file.write(content if isinstance(content, bytes) else content.encode())

    def answer(self, status, *arguments):
        result = self.run_program("check", *arguments)
        self.assertEqual((result.status, result.err), (status, ""), arguments)
        return result.out

    def test_a_crossing_is_named_and_placed(self):
        self.write("a.ply", PLY.format(bottom=-1))
        self.assertRegex(self.answer(CROSSINGS, "a.ply"),
                         r"^frame 0: ray_floret.12 triangle 0 and bract.7 triangle 1 at \(1.*, 1, 0\) mm\n"
                         r"1 crossing in 1 frame\n$")

    def test_triangles_apart_are_no_crossing(self):
        self.write("a.ply", PLY.format(bottom=1e-30))
        self.assertEqual(self.answer(DONE, "a.ply"), "0 crossings in 1 frame\n")

    def test_every_key_of_an_animation_is_checked(self):
        self.write("a.glb", glb())
        out = self.answer(CROSSINGS, "a.glb")
        self.assertRegex(out, r"^frame 1: petal.1 triangle 0 and petal.2 triangle 1 at \(1.*, 1, 0\) mm\n"
                              r"1 crossing in 3 frames\n$")
        self.assertEqual(self.answer(DONE, "a.glb", "--frame", "2"), "0 crossings in 1 frame\n")
        self.assertEqual(self.answer(CROSSINGS, "a.glb", "--frame", "1"), out.replace("3 frames", "1 frame"))
        self.assertEqual(self.answer(CROSSINGS, "a.glb", "--max-pairs", "0"),
                         "and 1 more\n1 crossing in 3 frames\n")

    def test_json_is_one_object(self):
        self.write("a.glb", glb())
        report = json.loads(self.answer(CROSSINGS, "a.glb", "--json"))
        for key in ["file", "version", "frames", "triangles", "crossings", "pairs", "degenerate", "seconds"]:
            self.assertIn(key, report)
        self.assertEqual((report["file"], report["frames"], report["triangles"], report["crossings"]),
                         ("a.glb", 3, 2, 1))
        pair = report["pairs"][0]
        self.assertEqual((pair["frame"], pair["first"], pair["second"]),
                         (1, {"part": "petal.1", "triangle": 0}, {"part": "petal.2", "triangle": 1}))
        self.assertAlmostEqual(pair["place_mm"][2], 0.0)

    def test_what_is_no_mesh_is_one_line(self):
        whole = glb()
        self.write("cut.glb", whole[:-40])
        self.write("cut.ply", PLY.format(bottom=-1)[:-9])
        self.write("empty.ply", "")
        for status, name, message in [
                (BAD_DATA, "cut.glb", f"cut.glb: header: must state the length of the file, {len(whole) - 40} bytes, got "
                                      f"{len(whole)}"),
                (BAD_DATA, "cut.ply", "cut.ply: face 1: must be whole: a number is missing or is none"),
                (BAD_DATA, "empty.ply", 'empty.ply: is neither a PLY nor a GLB file: must begin with "ply" or "glTF"'),
                (IO_FAILED, "missing.ply", "missing.ply: cannot open: No such file or directory")]:
            self.expect(status, "check", name, message=message)

    def test_the_frame_must_exist(self):
        self.write("a.glb", glb())
        self.expect(USAGE, "check", "a.glb", "--frame", "3",
                    message="--frame must be below the number of frames, 3, got 3")
        self.expect(USAGE, "check", message="FILE is required")

    def test_our_own_files_are_read(self):
        self.expect(DONE, "grow", "daisy", "-o", "a.ply", "-o", "a.glb", "--at", "0.3", "--detail", "0.3",
                    "--no-collisions")
        reports = []
        for name in ["a.ply", "a.glb"]:
            result = self.run_program("check", name, "--json")
            self.assertIn(result.status, [DONE, CROSSINGS])
            reports.append(json.loads(result.out))
        self.assertEqual(reports[0]["triangles"], reports[1]["triangles"])

    def test_threads_change_nothing(self):
        self.expect(DONE, "grow", "daisy", "-o", "a.ply", "--no-collisions", "--detail", "0.5")
        one, two = (self.run_program("check", "a.ply", "--threads", n) for n in ["1", "2"])
        self.assertEqual((one.status, one.out), (two.status, two.out))


if __name__ == "__main__":
    main()
