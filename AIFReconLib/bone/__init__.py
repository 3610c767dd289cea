"""Where bone is and how it faces, as a map on a voxel grid: from labels, from a probability, or from what frames
show, by a rule or a network.

May import resolve, io/, imaging/, sweep/, geometry/ and machine/.
"""
