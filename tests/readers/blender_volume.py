"""Draws a .vdb volume with Blender's Cycles:
blender -b --factory-startup --python-exit-code 1 -P blender_volume.py -- VOLUME SHOT OUT

SHOT and OUT as in mitsuba_volume.py, with Z up.
"""
import json
import math
import os
import sys

import bpy
from mathutils import Vector

volume, shot, out = sys.argv[-3], json.loads(sys.argv[-2]), sys.argv[-1]
bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene

bpy.ops.object.volume_import(filepath=volume)
material = bpy.data.materials.new("cloud")
material.use_nodes = True
nodes, links = material.node_tree.nodes, material.node_tree.links
nodes.clear()
surface, scatter, density = (nodes.new(kind) for kind in (
    "ShaderNodeOutputMaterial", "ShaderNodeVolumeScatter", "ShaderNodeAttribute"))
density.attribute_name = "density"
scatter.inputs["Color"].default_value = (1, 1, 1, 1)
scatter.inputs["Anisotropy"].default_value = shot["g"]
links.new(density.outputs["Fac"], scatter.inputs["Density"])
links.new(scatter.outputs[0], surface.inputs["Volume"])
bpy.context.object.data.materials.append(material)


def add(name, data):
    thing = bpy.data.objects.new(name, data)
    scene.collection.objects.link(thing)
    return thing


def looking(direction):
    return Vector(direction).to_track_quat("-Z", "Y").to_euler()


lens = bpy.data.cameras.new("camera")
lens.sensor_fit, lens.angle, lens.clip_end = "VERTICAL", math.radians(shot["vertical_fov_deg"]), 1e6
scene.camera = add("camera", lens)
scene.camera.location = shot["position"]
scene.camera.rotation_euler = looking(Vector(shot["target"]) - Vector(shot["position"]))
light = bpy.data.lights.new("sun", "SUN")
light.energy, light.angle = 1, 0
add("sun", light).rotation_euler = looking(-Vector(shot["to_sun"]))
scene.world = bpy.data.worlds.new("world")
scene.world.use_nodes = True
scene.world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0

render, cycles = scene.render, scene.cycles
render.engine = "CYCLES"
cycles.samples, cycles.use_adaptive_sampling, cycles.use_denoising = shot["samples"], False, False
cycles.max_bounces = cycles.volume_bounces = 1000
cycles.sample_clamp_indirect, cycles.pixel_filter_type, cycles.filter_width = 0, "BOX", 1
render.film_transparent = True
render.resolution_x, render.resolution_y = shot["size"]
render.image_settings.file_format, render.image_settings.color_depth = "OPEN_EXR", "32"
render.image_settings.color_mode = "RGBA"
render.filepath = out + ".exr"
bpy.ops.render.render(write_still=True)

picture = bpy.data.images.load(out + ".exr")
picture.alpha_mode = "PREMUL"
picture.colorspace_settings.name = "Non-Color"
values, (width, height) = list(picture.pixels), shot["size"]
pixels = [values[4 * i:4 * i + 4] for i in range(width * height)]
# Blender has the lowest row first.
rows = [pixels[width * y:width * (y + 1)] for y in reversed(range(height))]
with open(out, "w") as file:
    json.dump(sum(rows, []), file)
os.remove(out + ".exr")
