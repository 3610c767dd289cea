"""Which bone has been met, how squarely, what that will show, and where the probe must look next: nothing here turns pixels into voxels.

May import evaluation/ (the surface of bone, and what beams reach of it), registration/, compounding/ and everything below them.
"""
