"""The methods: a file each, which says what it needs, what it keeps of a voxel and what a pixel does to that. `table` lists them.

May import what all rooms share, and nothing else.
"""
