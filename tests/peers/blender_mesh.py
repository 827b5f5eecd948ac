"""Meshes, cameras and settings in Blender, for scripts that a Python with `bpy` runs."""

import time

import bpy
import numpy as np
from mathutils import Vector

# Rows: Blender's x, y and z of glTF's.
BLENDER_AXES = np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]], np.float32)
# Towards it, glTF's axes.
SUN = (0.5, 0.8, 1.0)


def made(given, axes: np.ndarray, v_up: bool):
    """A mesh with positions, normals, uvs and triangles of `given`, each corner a vertex of its own. Its UV map is `uv`."""
    corners = given["triangles"].ravel()
    of_corners = lambda name: np.ascontiguousarray(given[name][corners], np.float32)  # noqa: E731
    positions, normals, uvs = of_corners("positions") @ axes.T, of_corners("normals") @ axes.T, of_corners("uvs")
    if v_up:
        uvs[:, 1] = 1 - uvs[:, 1]
    mesh = bpy.data.meshes.new("corners")
    mesh.vertices.add(len(corners))
    mesh.vertices.foreach_set("co", positions.ravel())
    mesh.loops.add(len(corners))
    mesh.loops.foreach_set("vertex_index", np.arange(len(corners), dtype=np.int32))
    mesh.polygons.add(len(corners) // 3)
    mesh.polygons.foreach_set("loop_start", np.arange(0, len(corners), 3, dtype=np.int32))
    mesh.polygons.foreach_set("use_smooth", np.ones(len(corners) // 3, bool))
    # Free normals; normals_split_custom_set packs them in 16 bits.
    mesh.attributes.new("custom_normal", "FLOAT_VECTOR", "CORNER").data.foreach_set("vector", normals.ravel())
    mesh.uv_layers.new(name="uv").uv.foreach_set("vector", uvs.ravel())
    mesh.update()
    kept = np.empty(3 * len(corners), np.float32)
    mesh.corner_normals.foreach_get("vector", kept)
    worst = np.abs(kept - normals.ravel()).max()
    assert worst < 1e-6, f"normals are off by {worst}"
    return mesh


def look(scene, camera: dict) -> None:
    """The camera of a camera.json, its image square."""
    eye, target = (Vector(BLENDER_AXES @ np.array(camera[name], np.float32)) for name in ("eye", "target"))
    lens = bpy.data.cameras.new("camera")
    lens.sensor_fit, lens.angle = "VERTICAL", np.radians(camera["yfov_degrees"])
    far = (target - eye).length
    lens.clip_start, lens.clip_end = 1e-3 * far, 1e3 * far
    holder = bpy.data.objects.new("camera", lens)
    holder.location, holder.rotation_euler = eye, (target - eye).to_track_quat("-Z", "Y").to_euler()
    scene.collection.objects.link(holder)
    scene.camera = holder


def settle(scene, size: int, samples: int, out) -> None:
    """Cycles: direct light alone, a box filter of one pixel, linear f32."""
    scene.render.engine = "CYCLES"
    cycles = scene.cycles
    cycles.device, cycles.samples, cycles.max_bounces = "CPU", samples, 0
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.pixel_filter_type = "BOX"
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = cycles.blur_glossy = 0
    scene.render.film_transparent = True
    scene.render.resolution_x = scene.render.resolution_y = size
    scene.render.resolution_percentage = 100
    scene.render.image_settings.file_format, scene.render.image_settings.color_depth = "OPEN_EXR", "32"
    scene.render.image_settings.color_mode = "RGBA"
    scene.render.filepath = str(out)


def sun(scene) -> None:
    """A matte white surface that faces it sends 1 back."""
    lamp = bpy.data.lights.new("sun", "SUN")
    lamp.energy, lamp.angle = np.pi, 0
    holder = bpy.data.objects.new("sun", lamp)
    holder.rotation_euler = Vector(BLENDER_AXES @ np.array(SUN, np.float32)).to_track_quat("Z", "Y").to_euler()
    scene.collection.objects.link(holder)


def timed(repeat: int) -> dict:
    """Of so many renders of the composed scene, the file's writing included."""
    wall, cpu = [], []
    for _ in range(repeat):
        start, busy = time.perf_counter(), time.process_time()
        bpy.ops.render.render(write_still=True)
        wall.append(time.perf_counter() - start)
        cpu.append(time.process_time() - busy)
    return {"version": bpy.app.version_string, "wall_s": wall, "cpu_s": cpu}
