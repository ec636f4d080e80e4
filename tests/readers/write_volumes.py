"""Writes the volumes of tests/data/volumes by OpenVDB's own library: python3 write_volumes.py FOLDER"""
import sys

import numpy
import pyopenvdb as vdb


def bump(size, first):
    """1 in the middle of an ellipsoid, 0 at its surface, to whole 1/1024s, which half floats hold."""
    axes = [numpy.arange(n, dtype=numpy.float64) for n in size]
    i, j, k = numpy.meshgrid(*axes, indexing="ij")
    middle = [(n - 1) / 2 for n in size]
    reach = [n / 2 for n in size]
    square = sum(((x - m) / r) ** 2 for x, m, r in zip((i, j, k), middle, reach))
    values = numpy.round(1024 * numpy.maximum(0, 1 - square)) / 1024
    grid = vdb.FloatGrid()
    grid.copyFromArray(values.astype(numpy.float32), ijk=first)
    grid.gridClass = vdb.GridClass.FOG_VOLUME
    return grid


folder = sys.argv[1]
# Several grids, packed by Blosc with LZ4, as OpenVDB does by itself.
density = bump((20, 12, 9), (-3, 5, 100))
density.name = "density"
density.transform = vdb.createLinearTransform(voxelSize=0.5)
density.transform.translate((10, 20, 30))
tiles = vdb.FloatGrid()
tiles.name = "tiles"
# Blocks of 128, 8 and 1 voxels, the first two as tiles.
tiles.fill((128, 0, 0), (255, 127, 127), 0.25)
tiles.fill((256, 0, 0), (263, 7, 7), 0.5)
tiles.fill((264, 3, 2), (264, 3, 2), 0.75)
tiles.transform = vdb.createLinearTransform([[0, 2, 0, 0], [-2, 0, 0, 0], [0, 0, 3, 0], [7, 8, 9, 1]])
surface = vdb.createLevelSetSphere(radius=3.0, center=(20, 20, 20), voxelSize=1.0)
surface.name = "surface"
velocity = vdb.Vec3SGrid()
velocity.name = "velocity"
velocity.fill((0, 0, 0), (3, 3, 3), (1, 2, 3))
vdb.write(f"{folder}/grids.vdb", grids=[density, tiles, surface, velocity])
# Floats as halves; inactive voxels with a value of their own, and two of them.
half = bump((20, 12, 9), (-3, 5, 100))
half.name = "density"
half.saveFloatAsHalf = True
accessor = half.getAccessor()
for i in range(4):
    accessor.setValueOff((32 + i, 5, 100), 0.5)
for i in range(4):
    accessor.setValueOff((48 + i, 5, 100), 0.5 if i % 2 else 0.25)
    accessor.setValueOn((48 + i, 6, 100), 0.125)
vdb.write(f"{folder}/half.vdb", grids=[half])
