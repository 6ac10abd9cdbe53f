#!/usr/bin/env python3
"""Every key frame of a GLB file of ours that was grown with collisions, as a PLY file for cgal_judge.

    frames_of_glb.py flower.glb FOLDER                     writes FOLDER/frame-0000.ply and so on
    frames_of_glb.py flower.glb FOLDER --with cgal_judge   judges each and keeps those with crossings; exit status 1
                                                           if there are any

Nothing but Python itself, and nothing of the program: coordinates are base + target in single precision as the file
states them, in millimetres below its root.
"""

import argparse
import array
import json
import operator
import os
import struct
import subprocess
import sys

COMPONENTS = {5121: "B", 5123: "H", 5125: "I", 5126: "f"}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}


class Glb:
    def __init__(self, path):
        with open(path, "rb") as file:
            data = file.read()
        magic, version, size = struct.unpack_from("<4sII", data)
        if magic != b"glTF" or version != 2 or size != len(data):
            raise ValueError("not a whole GLB file")
        length, kind = struct.unpack_from("<I4s", data, 12)
        assert kind == b"JSON"
        self.json = json.loads(data[20 : 20 + length])
        self.binary = memoryview(data)[20 + length + 8 :]
        self.cache = {}

    def numbers(self, index):
        """The numbers of an accessor, one after the other; normalized ones are not needed here."""
        if index not in self.cache:
            accessor = self.json["accessors"][index]
            code = COMPONENTS[accessor["componentType"]]
            count = accessor["count"] * WIDTHS[accessor["type"]]
            assert "sparse" not in accessor and not accessor.get("normalized", False)
            if "bufferView" in accessor:
                view = self.json["bufferViews"][accessor["bufferView"]]
                assert "byteStride" not in view or view["byteStride"] == struct.calcsize(code) * WIDTHS[accessor["type"]]
                begin = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
                self.cache[index] = array.array(code, bytes(self.binary[begin : begin + count * struct.calcsize(code)]))
            else:
                self.cache[index] = array.array(code, [0] * count)
        return self.cache[index]


def channels_of(glb):
    """For each node its keyed properties: times and values."""
    keyed = {}
    for animation in glb.json.get("animations", []):
        for channel in animation["channels"]:
            sampler = animation["samplers"][channel["sampler"]]
            assert sampler.get("interpolation", "LINEAR") == "LINEAR"
            target = channel["target"]
            keyed.setdefault(target["node"], {})[target["path"]] = (
                glb.numbers(sampler["input"]),
                glb.numbers(sampler["output"]),
            )
    return keyed


def value_at(channel, time, count):
    """The `count` numbers of a channel at a key frame; between two of its own keys they must not change."""
    times, values = channel
    after = next((i for i, t in enumerate(times) if t >= time), len(times) - 1)
    found = list(values[after * count : (after + 1) * count])
    if after > 0 and times[after] > time:
        before = list(values[(after - 1) * count : after * count])
        if before != found:
            return None
    return found


class Frames:
    def __init__(self, glb):
        self.glb = glb
        self.keyed = channels_of(glb)
        self.times = sorted({t for paths in self.keyed.values() for times, _ in paths.values() for t in times}) or [0.0]

    def mesh_at(self, time):
        """Positions (x y z x y z ...) and corners of everything that is born."""
        positions = array.array("f")
        corners = array.array("I")
        for index, node in enumerate(self.glb.json["nodes"]):
            if "mesh" not in node:
                continue
            keyed = self.keyed.get(index, {})
            if "scale" in keyed:
                scale = value_at(keyed["scale"], time, 3)
                if scale is None or scale == [0.0, 0.0, 0.0]:
                    continue  # not born
                assert scale == [1.0, 1.0, 1.0], "a node is scaled: not a plant with collisions"
            mesh = self.glb.json["meshes"][node["mesh"]]
            assert not any(key in node for key in ("rotation", "matrix")), "a node is turned: not a plant with collisions"
            for primitive in mesh["primitives"]:
                assert primitive.get("mode", 4) == 4
                places = self.glb.numbers(primitive["attributes"]["POSITION"])
                targets = primitive.get("targets", [])
                if targets and "weights" in keyed:
                    weights = value_at(keyed["weights"], time, len(targets))
                    assert weights is not None and sorted(weights)[:-1] == [0.0] * (len(targets) - 1)
                    assert max(weights) in (0.0, 1.0), "not a key frame"
                    if max(weights) == 1.0:
                        shift = self.glb.numbers(targets[weights.index(1.0)]["POSITION"])
                        # Sums of two single-precision numbers are exact in double precision; array rounds them once.
                        places = array.array("f", map(operator.add, places, shift))
                first = len(positions) // 3
                positions.extend(places)
                corners.extend(corner + first for corner in self.glb.numbers(primitive["indices"]))
        return positions, corners


def write_ply(path, positions, corners):
    faces = len(corners) // 3
    header = (
        "ply\nformat binary_little_endian 1.0\n"
        f"element vertex {len(positions) // 3}\nproperty float x\nproperty float y\nproperty float z\n"
        f"element face {faces}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    with open(path, "wb") as file:
        file.write(header.encode())
        file.write(positions.tobytes())
        for begin in range(0, len(corners), 30000):
            part = corners[begin : begin + 30000]
            flat = [x for i in range(0, len(part), 3) for x in (3, part[i], part[i + 1], part[i + 2])]
            file.write(struct.pack("<" + "BIII" * (len(part) // 3), *flat))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("glb")
    parser.add_argument("folder")
    parser.add_argument("--with", dest="judge", help="the program that judges each frame")
    arguments = parser.parse_args()
    assert sys.byteorder == "little"
    os.makedirs(arguments.folder, exist_ok=True)
    frames = Frames(Glb(arguments.glb))
    faults = 0
    triangles = 0
    for number, time in enumerate(frames.times):
        path = os.path.join(arguments.folder, f"frame-{number:04}.ply")
        positions, corners = frames.mesh_at(time)
        write_ply(path, positions, corners)
        triangles = len(corners) // 3
        if arguments.judge:
            verdict = subprocess.run([arguments.judge, path], stdout=subprocess.PIPE, text=True, check=False)
            if verdict.returncode == 0:
                os.remove(path)
            else:
                faults += 1
                print(f"{arguments.glb}: {path}: {verdict.stdout.strip() or 'could not be judged'}")
    what = f"{len(frames.times)} key frames, {triangles} triangles in the last"
    if arguments.judge:
        what += f": {faults} with crossings" if faults else ": no crossings"
    print(f"{arguments.glb}: {what}")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
