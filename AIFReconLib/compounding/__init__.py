"""The distribution step: what happens when a pixel meets a voxel.

`reconstructor` owns the state and counts frames, `intake` makes of a frame what an engine takes, an engine does the arithmetic, `rules`
says in one place what the arithmetic is. `own/` runs methods that users register.
May import bone/, holes/, imaging/, sweep/, geometry/ and machine/.
"""
