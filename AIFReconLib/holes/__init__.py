"""The hole-filling step: empty voxels between measured ones take values from these, by the nearest or as the Plus toolkit does it.

Works on arrays; may import machine/.
"""
