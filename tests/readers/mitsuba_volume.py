"""Draws a .vol volume with Mitsuba 3: python3 mitsuba_volume.py VOLUME SHOT OUT

SHOT is JSON: size, samples, position, target, up, vertical_fov_deg, to_sun, g. OUT gets red, green, blue,
alpha of each pixel as JSON, row by row. The sun has irradiance 1.
"""
import json
import sys

import mitsuba as mi
import numpy as np

mi.set_variant("scalar_rgb")
volume, shot, out = sys.argv[1], json.loads(sys.argv[2]), sys.argv[3]
T = mi.ScalarTransform4f

with open(volume, "rb") as file:
    box = np.frombuffer(file.read(48)[24:], np.float32)
low, high = box[:3].astype(float), box[3:].astype(float)
place = T().translate(list((low + high) / 2)).scale(list((high - low) / 2))
scene = mi.load_dict({
    "type": "scene",
    "integrator": {"type": "volpath", "max_depth": 1000, "rr_depth": 200},
    "sun": {"type": "directional", "direction": [-x for x in shot["to_sun"]],
            "irradiance": {"type": "rgb", "value": 1.0}},
    "sensor": {
        "type": "perspective", "fov": shot["vertical_fov_deg"], "fov_axis": "y",
        "to_world": T().look_at(origin=shot["position"], target=shot["target"], up=shot["up"]),
        "film": {"type": "hdrfilm", "width": shot["size"][0], "height": shot["size"][1],
                 "rfilter": {"type": "box"}, "pixel_format": "rgba"},
        "sampler": {"type": "independent", "sample_count": shot["samples"]},
    },
    "box": {
        "type": "cube", "to_world": place, "bsdf": {"type": "null"},
        "interior": {"type": "heterogeneous", "albedo": 1.0, "phase": {"type": "hg", "g": shot["g"]},
                     "sigma_t": {"type": "gridvolume", "filename": volume, "use_grid_bbox": True}},
    },
})
with open(out, "w") as file:
    json.dump(np.array(mi.render(scene)).reshape(-1, 4).tolist(), file)
