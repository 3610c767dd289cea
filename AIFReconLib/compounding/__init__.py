"""The distribution step: what happens when a pixel meets a voxel.

`reconstructor` owns the state and counts frames, `frame_placement` makes of a frame what an engine takes, an engine does the
arithmetic, `rules` says in one place what it is. `own/` runs methods that users register.
May import bone/, holes/, imaging/, sweep/, geometry/ and machine/.
"""
