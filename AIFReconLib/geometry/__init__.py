"""Where things are: matrices, the graph of named transforms, interpolation of poses, voxel grids and the volumes on them.

May import machine/. `Volume.write` alone reaches up, into io/.
"""
