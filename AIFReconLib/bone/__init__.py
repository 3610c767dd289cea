"""Where bone is and how it faces, as a map on a voxel grid: from labels, from a probability, or from the sweep itself.

May import resolve, imaging/, sweep/, geometry/ and machine/.
"""
