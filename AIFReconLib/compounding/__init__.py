"""The distribution step: what happens when a pixel meets a voxel.

`reconstructor` owns the state and counts frames, an engine does the arithmetic, `rules` says in one place what the arithmetic is.
May import bone/, holes/, imaging/, sweep/, geometry/ and machine/.
"""
