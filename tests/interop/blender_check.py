"""blender --background --factory-startup --python blender_check.py -- FILE.glb TRUTH.json

Imports a file into Blender and compares it, at the times of TRUTH.json (which interop_truth writes), with what our player
says: whether each object is shown (its scale is not zero), where it stands, and the colour of the look that it shows.
Prints "blender: N states compared, M differ"; that line is missing when anything went wrong in between."""
import json
import sys

import bpy
import mathutils
import numpy

if not hasattr(numpy, "bool"):
    numpy.bool = bool  # Debian 12: the importer of Blender 3.4 uses a name that its numpy 1.24 no longer has

# glTF is Y up, Blender Z up: the importer turns the world, and with it every object's own coordinates.
TURN = mathutils.Matrix(((1, 0, 0, 0), (0, 0, -1, 0), (0, 1, 0, 0), (0, 0, 0, 1)))
HIDDEN_BELOW = 1e-6
TOLERANCE = 0.02  # of coordinates, m: Blender turns along a chord, not along the arc
COLOR_TOLERANCE = 1e-3
CUBIC = "motion: swings"  # the importer makes another curve of a cubic spline: known, and noticed when it changes


def shown(item):
    return max(abs(value) for value in item.matrix_world.to_scale()) > HIDDEN_BELOW


def base_color(mesh_object):
    shader = mesh_object.active_material.node_tree.nodes["Principled BSDF"]
    return list(shader.inputs["Base Color"].default_value)[:3]


def looks_of(name):
    """The meshes of an object, of which one is shown: itself, or its looks."""
    found = [item for item in (bpy.data.objects.get(name),) if item is not None and item.type == "MESH"]
    for number in range(9):
        look = bpy.data.objects.get(f"{name}/look_{number}")
        if look is not None:
            found.append(look)
    return found


def differences(name, expected_matrix, expected_color):
    """Yields what is not as it should be with one object that our player shows (or, with None, hides)."""
    meshes = looks_of(name)
    if not meshes:
        yield "is missing"
        return
    visible = [mesh for mesh in meshes if shown(mesh)]
    if len(visible) != (0 if expected_matrix is None else 1):
        yield f"shows {len(visible)} meshes"
        return
    if expected_matrix is None:
        return
    ours = mathutils.Matrix([expected_matrix[4 * i:4 * i + 4] for i in range(4)]).transposed()
    ours = TURN @ ours @ TURN.inverted()
    away = max(abs(a - b) for row, other in zip(visible[0].matrix_world, ours) for a, b in zip(row, other))
    if away > TOLERANCE:
        yield f"stands elsewhere: {away:.4f}"
    color = base_color(visible[0])
    if expected_color is not None and max(abs(a - b) for a, b in zip(color, expected_color)) > COLOR_TOLERANCE:
        yield f"has another color: {color} and not {expected_color}"


def main():
    path, truth_path = sys.argv[sys.argv.index("--") + 1:]
    with open(truth_path, encoding="utf-8") as stream:
        truth = json.load(stream)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=path)
    scene = bpy.context.scene
    compared = differ = cubic = 0
    for frame in truth["frames"]:
        at = frame["time_s"] * scene.render.fps / scene.render.fps_base
        scene.frame_set(int(at), subframe=at - int(at))
        for index, name in enumerate(truth["objects"]):
            found = list(differences(name, frame["matrices"].get(str(index)), frame["colors"].get(str(index))))
            if name == CUBIC:
                cubic += 1 if found else 0
                continue
            compared += 1
            differ += 1 if found else 0
            if found and differ <= 10:
                print(f"{name} at {frame['time_s']} s: {'; '.join(found)}")
    if CUBIC in truth["objects"] and cubic == 0:
        print("cubic splines play: say so in docs/INTEROP.md")
        differ += 1
    print(f"blender: {compared} states compared, {differ} differ")


main()
