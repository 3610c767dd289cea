"""What becomes of the voxels when the frames are in: values of the wanted type, holes filled; and the parts that a large box is worked in.

May import what compounding/ may, and its state.
"""
