"""blender --background --factory-startup --python blender_check.py -- FILE.glb TRUTH.json

Imports a file into Blender and compares it, at the times of TRUTH.json (which interop_truth writes), with what our player
says: whether each object is shown (its scale is not zero), where it stands, and the colour of the look that it shows. Objects
whose geometry was merged are found in the meshes by the attribute _OBJECT_ID of the file.
Prints "blender: N states compared, M differ"; that line is missing when anything went wrong in between."""
import json
import struct
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


def base_color(material):
    shader = material.node_tree.nodes["Principled BSDF"]
    return list(shader.inputs["Base Color"].default_value)[:3]


def read_glb(path):
    with open(path, "rb") as stream:
        data = stream.read()
    (length,) = struct.unpack_from("<I", data, 12)
    return json.loads(data[20:20 + length]), data[28 + length:]


def integers(document, binary, index):
    """The rows of an accessor of integers."""
    accessor = document["accessors"][index]
    view = document["bufferViews"][accessor["bufferView"]]
    kind = numpy.dtype({5121: "u1", 5123: "<u2", 5125: "<u4"}[accessor["componentType"]])
    width = {"SCALAR": 1, "VEC2": 2}[accessor["type"]]
    first = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
    strides = (view.get("byteStride", width * kind.itemsize), kind.itemsize)
    return numpy.ndarray((accessor["count"], width), kind, binary, first, strides).astype(numpy.int64)


class Whole:
    """A Blender object that is one object of ours, or a look of it."""

    def __init__(self, item):
        self.item = item

    def differences(self, matrix, _vertices):
        away = max(abs(a - b) for row, other in zip(self.item.matrix_world, matrix) for a, b in zip(row, other))
        if away > TOLERANCE:
            yield f"stands elsewhere: {away:.4f}"

    def color(self):
        return base_color(self.item.active_material)


class Part:
    """One object's share of a merged mesh."""

    def __init__(self, item, vertices, material):
        self.item = item
        self.vertices = vertices  # in the coordinates of the item
        self.material = material

    def differences(self, matrix, vertices):
        expected = box(vertices @ TURN_ARRAY.T, matrix)
        away = numpy.abs(box(self.vertices, self.item.matrix_world) - expected).max()
        if away > TOLERANCE:
            yield f"stands elsewhere: {away:.4f}"

    def color(self):
        return base_color(self.material)


TURN_ARRAY = numpy.array(TURN)[:3, :3]


def box(vertices, matrix):
    matrix = numpy.array(matrix)
    world = vertices @ matrix[:3, :3].T + matrix[:3, 3]
    return numpy.array([world.min(axis=0), world.max(axis=0)])


def parts_of(path):
    """{index of an object: its parts}, from the merged meshes of the file."""
    document, binary = read_glb(path)
    found = {}
    for node in document["nodes"]:
        primitives = document["meshes"][node["mesh"]]["primitives"] if "mesh" in node else []
        if not primitives or any("_OBJECT_ID" not in primitive["attributes"] for primitive in primitives):
            continue
        owners = []
        for primitive in primitives:  # the importer takes the vertices that are used, in their order
            ids = integers(document, binary, primitive["attributes"]["_OBJECT_ID"]) @ [1, 65536]
            if "indices" in primitive:
                ids = ids[numpy.unique(integers(document, binary, primitive["indices"]))]
            owners.append(ids)
        owners = numpy.concatenate(owners)
        item = bpy.data.objects[node["name"]]
        if len(item.data.vertices) != len(owners):
            raise ValueError(f"{node['name']}: {len(item.data.vertices)} vertices, not {len(owners)}")
        places = numpy.array([vertex.co for vertex in item.data.vertices])
        materials = {owners[polygon.vertices[0]]: item.data.materials[polygon.material_index] for polygon in item.data.polygons}
        order = numpy.argsort(owners, kind="stable")
        ids, firsts = numpy.unique(owners[order], return_index=True)
        for index, rows in zip(ids, numpy.split(order, firsts[1:])):
            found.setdefault(int(index), []).append(Part(item, places[rows], materials[index]))
    return found


def looks_of(name):
    """The meshes of an object, of which one is shown: itself, or its looks."""
    found = [item for item in (bpy.data.objects.get(name),) if item is not None and item.type == "MESH"]
    for number in range(9):
        look = bpy.data.objects.get(f"{name}/look_{number}")
        if look is not None:
            found.append(look)
    return [Whole(item) for item in found]


def differences(candidates, expected_matrix, expected_color, vertices):
    """Yields what is not as it should be with one object that our player shows (or, with None, hides)."""
    if not candidates:
        yield "is missing"
        return
    visible = [candidate for candidate in candidates if shown(candidate.item)]
    if len(visible) != (0 if expected_matrix is None else 1):
        yield f"shows {len(visible)} meshes"
        return
    if expected_matrix is None:
        return
    ours = mathutils.Matrix([expected_matrix[4 * i:4 * i + 4] for i in range(4)]).transposed()
    yield from visible[0].differences(TURN @ ours @ TURN.inverted(), vertices)
    if expected_color is not None:
        color = visible[0].color()
        if max(abs(a - b) for a, b in zip(color, expected_color)) > COLOR_TOLERANCE:
            yield f"has another color: {color} and not {expected_color}"


def main():
    path, truth_path = sys.argv[sys.argv.index("--") + 1:]
    with open(truth_path, encoding="utf-8") as stream:
        truth = json.load(stream)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=path)
    scene = bpy.context.scene
    parts = parts_of(path)
    candidates = [parts.get(index) or looks_of(name) for index, name in enumerate(truth["objects"])]
    vertices = [numpy.array(rows) for rows in truth["vertices"]]
    compared = differ = cubic = 0
    for frame in truth["frames"]:
        at = frame["time_s"] * scene.render.fps / scene.render.fps_base
        scene.frame_set(int(at), subframe=at - int(at))
        for index, name in enumerate(truth["objects"]):
            found = list(differences(candidates[index], frame["matrices"].get(str(index)), frame["colors"].get(str(index)),
                                     vertices[truth["meshes"][index]]))
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
    print(f"blender: {compared} states compared, {len(parts)} objects in merged meshes, {differ} differ")


main()
