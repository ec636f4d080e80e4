"""Writes a nephos scene from plain Python, as a script in a 3-D package would.

    python3 make_scene.py cloud.json
    nephos render cloud.json -o cloud.png

Metres, y up, +x east, -z north. What is left out has a default; `nephos schema`
prints every field with its unit and range.
"""

import json
import math
import sys

BASE = 1000.0

# A ring of flat lumps on the base, one heap in the middle.
ellipsoids = [{"center": [0, BASE + 110, 0], "radii": [120, 110, 120]}]
for i in range(7):
    angle = 2 * math.pi * i / 7
    center = [130 * math.cos(angle), BASE + 50, 130 * math.sin(angle)]
    ellipsoids.append({"center": center, "radii": [85, 50, 85]})

scene = {
    "name": "ring",
    "clouds": [{"ellipsoids": ellipsoids, "edge": {"boundary": 30, "wispiness": 0.2}}],
    "sun": {"position": {"angles": {"azimuth_deg": 230, "elevation_deg": 35}}},
}

with open(sys.argv[1] if len(sys.argv) > 1 else "scene.json", "w") as file:
    json.dump(scene, file, indent=2)
