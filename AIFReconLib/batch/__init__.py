"""Many cases: a table of them becomes volumes, metrics and one page, on this computer's cores or on a cluster, by Dask.

May import terminal/ and what stands below it; dask, distributed and pyarrow are imported here alone, and late.
"""
