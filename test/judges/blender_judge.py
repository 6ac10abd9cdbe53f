"""Opens a GLB in Blender, plays it to the expected times, and compares organs and vertex positions.

    blender --background --factory-startup --python-exit-code 1 -noaudio -P blender_judge.py -- FILE.glb EXPECTED.json

Exits 1 on any fault. EXPECTED.json is what expected_positions_json wrote. Times must fall on whole frames at 24 frames
a second, as the keys of 25 frames in 4 s do: those are the frames that people look at.
"""
import json
import math
import sys
import time

import bpy
import numpy as np

if not hasattr(np, "bool"):
    np.bool = np.bool_  # the importer of Blender 3.4 uses a name that NumPy 1.24 dropped

FPS = 24
glb_path, expected_path = sys.argv[sys.argv.index("--") + 1:][:2]
with open(expected_path, encoding="utf-8") as file:
    expected = json.load(file)

started = time.monotonic()
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.preferences.addon_enable(module="io_scene_gltf2")
scene = bpy.context.scene
scene.render.fps = FPS
bpy.ops.import_scene.gltf(filepath=glb_path)
imported_s = time.monotonic() - started

faults = []


def parts(obj):
    """The mesh of an organ, or those of its parts, in the order of the file."""
    if obj.type == "MESH":
        return [obj]
    return sorted((child for child in obj.children if child.type == "MESH"), key=lambda child: child["part"])


organs = {}
named = {}
for obj in bpy.data.objects:
    if "organ" in obj:
        organs[obj["organ"]] = obj
    elif "part" not in obj:
        named[obj.name] = obj
if len(organs) != len(expected["organs"]):
    faults.append(f"{len(organs)} organs, must be {len(expected['organs'])}")

largest = 0.0
compared = 0
for index, seconds in enumerate(expected["times_s"]):
    frame = seconds * FPS
    if abs(frame - round(frame)) > 1e-6:
        faults.append(f"{seconds} s is not a whole frame at {FPS} a second")
    scene.frame_set(round(frame))
    graph = bpy.context.evaluated_depsgraph_get()
    for item in expected["organs"] + expected["bodies"]:
        obj = organs.get(item["organ"]) if "organ" in item else named.get(item["name"])
        if obj is None:
            faults.append(f"{item['name']} is missing")
            continue
        points = []  # (mesh, matrix) of each part, and where its vertices begin
        first = 0
        places = {}
        for part in parts(obj):
            evaluated = part.evaluated_get(graph)
            vertices = evaluated.data.vertices
            for vertex in item["vertices"]:
                if first <= vertex < first + len(vertices):
                    places[vertex] = evaluated.matrix_world @ vertices[vertex - first].co
            first += len(vertices)
        if first != item["vertex_count"]:
            faults.append(f"{item['name']} has {first} vertices, must be {item['vertex_count']}")
            continue
        wanted = item["positions"][index]
        if wanted is None:
            spread = max((p - places[item["vertices"][0]]).length for p in places.values())
            if spread > 1e-9:
                faults.append(f"{item['name']} at {seconds:.3f} s is not born and yet {spread} m wide")
            continue
        for vertex, point in zip(item["vertices"], wanted):
            # Blender turns glTF's +Y up into +Z up: (x, y, z) becomes (x, -z, y).
            found = places[vertex]
            gap = math.dist((found.x, found.z, -found.y), point)
            compared += 1
            largest = max(largest, gap)
            if not gap <= item["tolerance_m"]:
                faults.append(f"{item['name']} vertex {vertex} at {seconds:.3f} s is {1000 * gap:.3g} mm off, "
                              f"more than {1000 * item['tolerance_m']:.3g}")

times = ", ".join(f"{seconds:.3f}" for seconds in expected["times_s"])
print(f"Blender {bpy.app.version_string}: {len(organs)} organs, {len(bpy.data.meshes)} meshes, "
      f"{len(bpy.data.actions)} actions, {compared} vertices at times {times} s, largest distance "
      f"{1000 * largest:.3g} mm, import {imported_s:.1f} s, all {time.monotonic() - started:.1f} s, "
      f"{len(faults)} faults")
for fault in faults[:10]:
    print("  " + fault)
if len(faults) > 10:
    print(f"  and {len(faults) - 10} more")
sys.exit(1 if faults else 0)
