"""Slicer's nodes as inputs of AIFReconLib, and its results as nodes. No Qt here: everything runs on a bare MRML scene.

Nodes are placed in RAS world by their parent transforms. Matrices are `aToB` on column vectors in mm, arrays of volumes [k, j, i].
"""
