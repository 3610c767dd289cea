"""What a volume file holds, before it is judged and placed."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from ...arrays import Matrix, Numbers


@dataclass(frozen=True, eq=False)
class StoredVolume:
    """Voxels and their place, as a file gives them.

    Parameters
    ----------
    path : Path
    array : [k, j, i] array, or [k, j, i, n] for several values per voxel
    ijk_to_lps : (4, 4) float64 array, mm
        Not checked yet.
    keys : tuple of str
        Names of the file's own fields, by which segmentations are told.
    """

    path: Path
    array: Numbers
    ijk_to_lps: Matrix
    keys: tuple[str, ...] = ()

    @property
    def components(self) -> int:
        """Values per voxel."""
        return self.array.shape[3] if self.array.ndim == 4 else 1
