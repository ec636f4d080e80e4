"""Tells what OpenVDB finds in a volume, as JSON: python3 openvdb_volume.py FILE [I,J,K ...]"""
import json
import sys

import pyopenvdb as vdb

grids, _ = vdb.readAll(sys.argv[1])
grid = grids[0]
accessor = grid.getConstAccessor()
voxels = [tuple(int(i) for i in word.split(",")) for word in sys.argv[2:]]
print(json.dumps({
    "grids": [g.name for g in grids],
    "class": grid.gridClass,
    "type": type(grid).__name__,
    "background": grid.background,
    "active": grid.activeVoxelCount(),
    "bounds": grid.evalActiveVoxelBoundingBox(),
    "voxel": grid.transform.voxelSize(),
    "world": [grid.transform.indexToWorld(voxel) for voxel in voxels],
    "values": [accessor.getValue(voxel) for voxel in voxels],
    "others": [{
        "type": type(other).__name__,
        "active": other.activeVoxelCount(),
        "background": other.background,
        "values": [other.getConstAccessor().getValue(voxel) for voxel in voxels],
        "metadata": {key: str(value) for key, value in other.metadata.items()},
    } for other in grids[1:]],
    "metadata": {key: str(value) for key, value in grid.metadata.items()},
}))
