"""A scene file as a dictionary for Mitsuba 3. What Mitsuba has no counterpart for is an error that names it."""

import json
import math
import pathlib
import re

import mitsuba as mi
import numpy as np


# Half the side of the square that stands for an infinite plane: farther, and floats blur what stands on it.
PLANE_REACH = 1e3


class Unsupported(Exception):
    pass


def read(path):
    text = pathlib.Path(path).read_text(encoding="utf-8")
    return json.loads(re.sub(r'("(?:\\.|[^"\\])*")|//[^\n]*', lambda m: m.group(1) or "", text))


def rgb(color, what):
    if isinstance(color, str):
        levels = [int(color[i:i + 2], 16) / 255 for i in (1, 3, 5)]
        color = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in levels]
    if not isinstance(color, list):
        raise Unsupported(f"{what}: textures are not converted")
    return {"type": "rgb", "value": color}


def bsdf(material, name):
    """None for an emitter."""
    kind, roughness = material["type"], material.get("roughness", 0)
    if isinstance(roughness, dict):
        raise Unsupported(f"{name}: textures are not converted")
    if kind == "emitter":
        return None
    if kind == "diffuse":
        lambertian = {"type": "diffuse", "reflectance": rgb(material.get("albedo", [0.8] * 3), name)}
        return {"type": "twosided", "bsdf": lambertian}
    if kind == "metal" and not material.get("multiscatter", False):
        facets = {"type": "roughconductor", "distribution": "ggx", "alpha": roughness ** 2} if roughness > 0 else {
            "type": "conductor"}
        reflectance = rgb(material.get("albedo", [0.9] * 3), name)
        return {"type": "twosided", "bsdf": {**facets, "material": "none", "specular_reflectance": reflectance}}
    if kind == "dielectric" and roughness == 0:
        tint = rgb(material.get("tint", [1] * 3), name)
        return {"type": "dielectric", "int_ior": material.get("ior", 1.5), "ext_ior": 1.0,
                "specular_transmittance": tint}
    raise Unsupported(f"{name}: this material of type {kind} has no exact counterpart")


def matrix(transform):
    if "matrix" in transform:
        return np.array(transform["matrix"], dtype=float).reshape(4, 4).T
    move, turn, size = np.eye(4), np.eye(4), np.eye(4)
    move[:3, 3] = transform.get("translate", [0, 0, 0])
    size[[0, 1, 2], [0, 1, 2]] = transform.get("scale", 1)
    rotate = transform.get("rotate", [0, 0, 0, 1])
    if isinstance(rotate, dict):
        half = math.radians(rotate["degrees"]) / 2
        axis = np.array(rotate["axis"], dtype=float)
        rotate = [*(axis / np.linalg.norm(axis) * math.sin(half)), math.cos(half)]
    x, y, z, w = rotate
    turn[:3, :3] = [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                    [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                    [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]
    return move @ turn @ size


def flat(columns, at):
    """The transform that takes the axes to these columns and the origin to `at`."""
    m = np.eye(4)
    m[:3, :3] = np.array(columns, dtype=float).T
    m[:3, 3] = at
    return m


def write_triangle(vertices, path):
    corners = "".join(f"{v[0]!r} {v[1]!r} {v[2]!r}\n" for v in vertices)
    header = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    path.write_text(f"{header}element face 1\nproperty list uchar int vertex_indices\nend_header\n{corners}3 0 1 2\n")


def shape(entry, name, folder, scratch):
    kind, to_world = entry["type"], matrix(entry.get("transform", {}))
    if kind == "sphere":
        return {"type": "sphere", "center": entry["center"], "radius": entry["radius"]}, to_world
    if kind == "quad":
        u, v, p = (np.array(entry[key], dtype=float) for key in ("u", "v", "point"))
        normal = np.cross(u, v) / np.linalg.norm(np.cross(u, v))
        return {"type": "rectangle"}, to_world @ flat([u / 2, v / 2, normal], p + (u + v) / 2)
    if kind == "plane":
        normal = np.array(entry["normal"], dtype=float) / np.linalg.norm(entry["normal"])
        u = np.cross(normal, np.eye(3)[np.argmin(np.abs(normal))])
        u /= np.linalg.norm(u)
        sides = PLANE_REACH * u, PLANE_REACH * np.cross(normal, u), normal
        return {"type": "rectangle"}, to_world @ flat(sides, entry["point"])
    if kind == "box":
        lo, hi = np.array(entry["min"], dtype=float), np.array(entry["max"], dtype=float)
        return {"type": "cube"}, to_world @ flat(np.diag((hi - lo) / 2), (hi + lo) / 2)
    if kind == "triangle":
        path = scratch / f"{name}.ply"
        write_triangle(entry["vertices"], path)
        return {"type": "ply", "filename": str(path), "face_normals": True}, to_world
    if kind == "mesh":
        path = folder / entry["file"]
        smooth = path.suffix == ".obj" and re.search(r"^vn ", path.read_text(errors="replace"), re.MULTILINE)
        return {"type": path.suffix[1:], "filename": str(path), "face_normals": not smooth}, to_world
    raise Unsupported(f"{name}: a {kind} has no counterpart")


def flattened(objects, parent=np.eye(4)):
    """Each visible object that is no list, with what takes the space of its list to the world."""
    for entry in objects:
        if not entry.get("visible", True):
            continue
        if entry["type"] == "list":
            yield from flattened(entry["objects"], parent @ matrix(entry.get("transform", {})))
        else:
            yield entry, parent


def sensor(scene):
    camera, film = scene["camera"], scene["film"]
    look = mi.ScalarTransform4f().look_at(origin=camera["position"], target=camera["target"], up=camera.get("up", [0, 1, 0]))
    result = {"type": "perspective", "fov": camera["vfov"], "fov_axis": "y", "to_world": look, "near_clip": 1e-4,
              "far_clip": 1e6, "sampler": {"type": "multijitter"},
              "film": {"type": "hdrfilm", "width": film["width"], "height": film["height"], "pixel_format": "rgb",
                       "component_format": "float32", "rfilter": {"type": "box"}}}
    if camera.get("lens_radius", 0) > 0:
        result |= {"type": "thinlens", "aperture_radius": camera["lens_radius"], "focus_distance": camera["focus_distance"]}
    return result


def environment(description):
    if description["type"] == "constant":
        return {"type": "constant", "radiance": rgb(description["radiance"], "environment")}
    if description["type"] == "gradient":
        rows = 512
        y = np.cos((np.arange(rows) + 0.5) * math.pi / rows)
        share = ((y + 1) / 2)[:, None]
        bottom, top = (np.array(rgb(description[key], "environment")["value"]) for key in ("bottom", "top"))
        image = np.repeat(((1 - share) * bottom + share * top)[:, None, :], 4, axis=1).astype(np.float32)
        return {"type": "envmap", "bitmap": mi.Bitmap(image), "mis_compensation": False}
    raise Unsupported(f"environment: {description['type']} is not converted")


def convert(path, scratch):
    """The dictionary for mi.load_dict. `scratch` is a folder for meshes made on the way."""
    scene, folder = read(path), pathlib.Path(path).parent
    bounces = scene.get("render", {}).get("max_bounces", 8)
    result = {"type": "scene", "sensor": sensor(scene),
              "integrator": {"type": "path", "max_depth": bounces + 1, "rr_depth": 5}}
    if scene.get("environment"):
        result["environment"] = environment(scene["environment"])
    for i, (entry, parent) in enumerate(flattened(scene["objects"])):
        name = f"object_{i}"
        made, to_world = shape(entry, name, folder, scratch)
        made["to_world"] = mi.ScalarTransform4f(parent @ to_world)
        material = scene["materials"][entry["material"]]
        surface = bsdf(material, f"materials.{entry['material']}")
        if surface:
            made["bsdf"] = surface
        elif material.get("two_sided", False):
            raise Unsupported(f"materials.{entry['material']}: emitters of two sides have no counterpart")
        else:
            made |= {"emitter": {"type": "area", "radiance": rgb(material["radiance"], "emitter")},
                     "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": 0.0}}}
        result[name] = made
    return result
