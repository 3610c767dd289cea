"""The engine that numba compiles: the same voxels as the numpy engine's, many times as fast.

Files called `numba_*` are imported only where numba works; `engines` decides.
"""
