"""A bone map brought to the voxels of a reconstruction: to all of them, or to those that are asked for.

May import what the bone map's own room may; the map itself imports this.
"""
