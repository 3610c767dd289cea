"""What the views show: volumes in slices, 3D, outlines of bone, the probe.

May import volumes/, inputs/ and sweep/.
"""
