"""Renders scene files with Blender's Cycles. Run by Blender's Python, never imported by tpvqa.

Needs only `bpy` and NumPy. Reads one job a line from standard input, as JSON:
`{"scene": FILE.npz, "out": FILE.png}`; answers each with one line, `{"out": …, "seconds": …}` or
`{"out": …, "error": …}`. What is in a scene file stands in `scene_file.py`.
"""

import argparse
import json
import math
import os
import sys
import time
from typing import Any

import bpy
import numpy as np

# isort: split
# These come with bpy, and only once it is imported.
import bmesh
import mathutils


def linear(rgb: list[float]) -> list[float]:
    """Display colour to scene-linear colour."""
    return [x / 12.92 if x <= 0.04045 else ((x + 0.055) / 1.055) ** 2.4 for x in rgb]


def image(name: str, pixels: Any) -> Any:
    """A texture as a Blender image; the first row lies at v = 0, as in MuJoCo."""
    height, width = pixels.shape[:2]
    made = bpy.data.images.new(name, width, height)
    rgba = np.ones((height, width, 4), np.float32)
    rgba[..., :3] = pixels / 255.0
    made.pixels.foreach_set(rgba.ravel())
    made.pack()
    return made


def material(spec: dict[str, Any], images: dict[int, Any]) -> Any:
    """A principled material from a material of the scene file."""
    made = bpy.data.materials.new(spec["name"])
    made.use_nodes = True
    nodes, links = made.node_tree.nodes, made.node_tree.links
    surface = nodes["Principled BSDF"]
    tint = [*linear(spec["rgba"][:3]), 1.0]
    surface.inputs["Base Color"].default_value = tint
    surface.inputs["Roughness"].default_value = spec["roughness"]
    surface.inputs["Metallic"].default_value = spec["metallic"]
    surface.inputs["Alpha"].default_value = spec["rgba"][3]
    glow = "Emission Color"
    surface.inputs["Emission Strength"].default_value = spec["emission"]
    surface.inputs[glow].default_value = tint
    if spec["texture"] is not None:
        picture = nodes.new("ShaderNodeTexImage")
        picture.image = images[spec["texture"]]
        mix = nodes.new("ShaderNodeMix")
        mix.data_type, mix.blend_type = "RGBA", "MULTIPLY"
        factor, a, b, result = mix.inputs[0], mix.inputs[6], mix.inputs[7], mix.outputs[2]
        factor.default_value = 1.0
        b.default_value = tint
        links.new(picture.outputs["Color"], a)
        if spec["emission"] > 0:
            links.new(result, surface.inputs[glow])
        if spec["emission"] > 0.5:
            surface.inputs["Base Color"].default_value = (0, 0, 0, 1)
        else:
            links.new(result, surface.inputs["Base Color"])
    elif spec["emission"] > 0.5:
        surface.inputs["Base Color"].default_value = (0, 0, 0, 1)
    return made


def primitive(shape: str, size: list[float]) -> Any:
    """A plane, box, sphere, ellipsoid, cylinder or capsule about the origin."""
    made = bmesh.new()
    if shape == "plane":
        x, y = size[0] or 10.0, size[1] or 10.0
        corners = [made.verts.new(p) for p in ((-x, -y, 0), (x, -y, 0), (x, y, 0), (-x, y, 0))]
        made.faces.new(corners)
    elif shape == "box":
        scale = mathutils.Matrix.Diagonal((size[0], size[1], size[2], 1))
        bmesh.ops.create_cube(made, size=2, matrix=scale)
    elif shape in ("sphere", "ellipsoid"):
        x, y, z = (size[0],) * 3 if shape == "sphere" else size
        scale = mathutils.Matrix.Diagonal((x, y, z, 1))
        bmesh.ops.create_uvsphere(made, u_segments=32, v_segments=18, radius=1, matrix=scale)
    else:
        r, h = size[0], size[1]
        bmesh.ops.create_cone(
            made, segments=32, radius1=r, radius2=r, depth=2 * h, cap_ends=shape == "cylinder"
        )
        if shape == "capsule":
            for end in (-h, h):
                place = mathutils.Matrix.Translation((0, 0, end))
                bmesh.ops.create_uvsphere(
                    made, u_segments=32, v_segments=16, radius=r, matrix=place
                )
    return made


def unwrap(made: Any, size: list[float], spec: dict[str, Any]) -> None:
    """Texture coordinates by the axis that a face looks along, as wide as MuJoCo repeats them."""
    layer = made.loops.layers.uv.new()
    repeat, uniform = spec["repeat"], spec["uniform"]
    made.normal_update()
    for face in made.faces:
        axis = max(range(3), key=lambda k: abs(face.normal[k]))
        u, v = [k for k in range(3) if k != axis]
        for loop in face.loops:
            point = loop.vert.co
            across = []
            for k, times in ((u, repeat[0]), (v, repeat[1])):
                extent = 2 * (size[k] or 1.0) if k < len(size) else 1.0
                part = point[k] / 2 if uniform else point[k] / extent + 0.5
                across.append(part * times)
            loop[layer].uv = across


def part(spec: dict[str, Any], arrays: Any, materials: list[Any], specs: list[Any]) -> Any:
    """A Blender object from a part of the scene file."""
    size = spec["size"]
    shape = spec["shape"]
    if shape == "mesh":
        number = spec["mesh"]
        mesh = bpy.data.meshes.new(f"mesh{number}")
        vertices, faces = arrays[f"vertices_{number}"], arrays[f"faces_{number}"]
        mesh.from_pydata(vertices.tolist(), [], faces.tolist())
        if f"uv_{number}" in arrays:
            layer = mesh.uv_layers.new()
            layer.data.foreach_set("uv", arrays[f"uv_{number}"].astype(np.float32).ravel())
    else:
        made = primitive(shape, size)
        if specs[spec["material"]]["texture"] is not None:
            unwrap(made, size, specs[spec["material"]])
        mesh = bpy.data.meshes.new(shape)
        made.to_mesh(mesh)
        made.free()
    if shape not in ("plane", "box") and len(mesh.polygons):
        mesh.shade_smooth()
        mesh.set_sharp_from_angle(angle=0.6)
    mesh.materials.append(materials[spec["material"]])
    thing = bpy.data.objects.new("part", mesh)
    thing.matrix_world = mathutils.Matrix(spec["matrix"])
    if shape == "box" and min(size) > 0.004:
        rounded = thing.modifiers.new("edges", "BEVEL")
        rounded.width, rounded.segments = min(0.003, min(size) / 4), 2
    return thing


def light(spec: dict[str, Any]) -> Any:
    """A soft area light that looks at a point."""
    lamp = bpy.data.lights.new("light", "AREA")
    lamp.energy, lamp.size, lamp.color = spec["watts"], spec["size"], linear(spec["colour"])
    thing = bpy.data.objects.new("light", lamp)
    thing.location = spec["position"]
    towards = mathutils.Vector(spec["target"]) - mathutils.Vector(spec["position"])
    thing.rotation_euler = towards.to_track_quat("-Z", "Y").to_euler()
    return thing


def render(job: dict[str, str], settings: argparse.Namespace) -> None:
    """Build the scene of a job and render it."""
    arrays = np.load(job["scene"], allow_pickle=False)
    scene_spec = json.loads(str(arrays["scene"]))
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    images = {
        int(name.split("_")[1]): image(name, arrays[name])
        for name in arrays.files
        if name.startswith("texture_")
    }
    specs = scene_spec["materials"]
    materials = [material(spec, images) for spec in specs]
    for spec in scene_spec["parts"]:
        scene.collection.objects.link(part(spec, arrays, materials, specs))
    for spec in scene_spec["lights"]:
        scene.collection.objects.link(light(spec))

    world = bpy.data.worlds.new("world")
    scene.world = world
    world.use_nodes = True
    background = world.node_tree.nodes["Background"]
    background.inputs[0].default_value = (*linear(scene_spec["background"]["colour"]), 1)
    background.inputs[1].default_value = scene_spec["background"]["strength"]

    lens = bpy.data.cameras.new("camera")
    lens.sensor_fit, lens.clip_start = "VERTICAL", 0.02
    lens.angle_y = math.radians(scene_spec["camera"]["fovy"])
    camera = bpy.data.objects.new("camera", lens)
    camera.matrix_world = mathutils.Matrix(scene_spec["camera"]["matrix"])
    scene.collection.objects.link(camera)
    scene.camera = camera

    scene.view_settings.view_transform = "AgX"
    scene.view_settings.look = "AgX - Medium High Contrast"
    scene.view_settings.exposure = scene_spec["exposure"]
    scene.render.engine = "CYCLES"
    cycles = scene.cycles
    cycles.device, cycles.samples, cycles.seed = "CPU", settings.samples, scene_spec["seed"]
    cycles.use_denoising, cycles.use_adaptive_sampling = True, False
    cycles.max_bounces, cycles.use_light_tree = 4, False
    cycles.denoising_prefilter, cycles.caustics_reflective = "FAST", False
    cycles.caustics_refractive = False
    scene.render.threads_mode, scene.render.threads = "FIXED", settings.threads
    scene.render.resolution_x = scene.render.resolution_y = settings.size
    scene.render.image_settings.file_format = "PNG"
    scene.render.filepath = os.path.abspath(job["out"])
    bpy.ops.render.render(write_still=True)


def main() -> None:
    """Answer jobs until standard input ends."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--samples", type=int, default=8)
    parser.add_argument("--size", type=int, default=256)
    settings = parser.parse_args()
    # Blender prints to standard output: keep that for answers, send its talk to standard error.
    answers = os.fdopen(os.dup(1), "w", buffering=1)
    os.dup2(2, 1)
    print(json.dumps({"ready": bpy.app.version_string}), file=answers, flush=True)
    for line in sys.stdin:
        job = json.loads(line)
        began = time.monotonic()
        try:
            render(job, settings)
            said = {"out": job["out"], "seconds": round(time.monotonic() - began, 2)}
        except Exception as error:  # noqa: BLE001 - one bad scene must not end the others
            said = {"out": job["out"], "error": f"{type(error).__name__}: {error}"}
        print(json.dumps(said), file=answers, flush=True)


if __name__ == "__main__":
    main()
    sys.stdout.flush()
    os._exit(0)  # bpy can crash in its own clean-up at interpreter exit
