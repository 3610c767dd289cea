"""Transform files of programs that no test can start: made with h5py 3.16, so by the HDF5 library."""

from __future__ import annotations

from pathlib import Path

_FOLDER = Path(__file__).with_name("hdf5")

OLDER_HDF5 = (_FOLDER / "older.h5").read_bytes()
"""As ITK 4 and Slicer 4: superblock 0, groups as symbol tables, names misspelt; a composite of two affine transforms."""

COMPRESSED_HDF5 = (_FOLDER / "compressed.h5").read_bytes()
"""As ITK 5 where it is asked to compress, as ANTs does: one affine transform, each list of its numbers in a compressed chunk."""
