"""Plays growing veins in Blender and compares what shows at each moment with the tubes of a PLY of that moment.

    blender --background --factory-startup --python-exit-code 1 -noaudio -P veins_blender.py -- FILE.glb MOMENT.ply ...

As many triangles and the same box; Blender reads both files. Exits 1 on any fault.
"""
import sys

import bpy
import numpy as np

if not hasattr(np, "bool"):
    np.bool = np.bool_  # the importer of Blender 3.4 uses a name that NumPy 1.24 dropped

FPS = 24
SECONDS = 4
TOLERANCE_MM = 1e-3  # Blender keeps the placing of a node in single precision
KINDS = ["floret", "abaxial", "adaxial"]
glb_path, *ply_paths = sys.argv[sys.argv.index("--") + 1:]

bpy.ops.wm.read_factory_settings(use_empty=True)
for module in ["io_scene_gltf2", "io_mesh_ply"]:
    bpy.ops.preferences.addon_enable(module=module)
scene = bpy.context.scene
scene.render.fps = FPS
bpy.ops.import_scene.gltf(filepath=glb_path)


def triangles_and_box(meshes):
    """Of (vertices in mm, triangles) of several meshes."""
    count = sum(len(triangles) for _, triangles in meshes)
    points = np.concatenate([points[triangles.ravel()] for points, triangles in meshes]) if count else np.zeros((1, 3))
    return count, np.array([points.min(axis=0), points.max(axis=0)])


def shown():
    """The strands of the kinds that can be seen now."""
    found = []
    graph = bpy.context.evaluated_depsgraph_get()
    for item in bpy.data.objects:
        if item.type != "MESH" or not any(slot.name in KINDS for slot in item.material_slots):
            continue
        evaluated = item.evaluated_get(graph)
        matrix = np.array(evaluated.matrix_world)
        if abs(np.linalg.det(matrix[:3, :3])) < 1e-15:
            continue
        mesh = evaluated.data
        points = np.empty(3 * len(mesh.vertices), dtype=np.float32)
        mesh.vertices.foreach_get("co", points)
        points = points.reshape(-1, 3) @ matrix[:3, :3].T + matrix[:3, 3]
        corners = np.empty(3 * len(mesh.polygons), dtype=np.int32)
        mesh.polygons.foreach_get("vertices", corners)
        found.append((1000 * points, corners.reshape(-1, 3)))
    return found


faults = []
counts = []
for moment, path in enumerate(ply_paths):
    frame = (moment + 0.5) / len(ply_paths) * SECONDS * FPS
    scene.frame_set(round(frame))
    found, found_box = triangles_and_box(shown())
    with open(path, "rb") as file:
        header = file.read(4096).split(b"end_header")[0].decode()
    wanted = int(header.split("element face ")[1].split()[0])
    counts.append(found)
    if found != wanted:
        faults.append(f"{path} has {wanted} triangles, the GLB shows {found}")
    if wanted == 0:
        continue
    bpy.ops.import_mesh.ply(filepath=path)
    mesh = bpy.context.object.data
    points = np.array([vertex.co for vertex in mesh.vertices])
    box = np.array([points.min(axis=0), points.max(axis=0)])
    if len(mesh.polygons) != wanted:
        faults.append(f"{path}: Blender reads {len(mesh.polygons)} triangles of {wanted}")
    gap = np.abs(box - found_box).max()
    if not gap <= TOLERANCE_MM:
        faults.append(f"{path}: the box is {gap} mm off")
    bpy.data.objects.remove(bpy.context.object)

print(f"Blender {bpy.app.version_string}: {glb_path} shows {', '.join(map(str, counts))} triangles of veins, "
      f"{len(faults)} faults")
for fault in faults:
    print(f"  {fault}")
sys.exit(1 if faults else 0)
