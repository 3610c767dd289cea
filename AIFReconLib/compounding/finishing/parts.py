"""A box too large for the memory is worked in parts: slabs of whole planes, each with the voxels that it has in the whole."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from ...geometry.volume import VoxelGrid
from ...machine.memory import LARGEST_GRID, MAXIMUM_VOXELS, SAFETY, available_memory, require_memory

PART_OF_FREE = 0.75
"""Of the free memory, what a reconstruction takes where nobody says."""

Planes = tuple[int, int]
"""First plane [k], and the one after the last."""


@dataclass(frozen=True)
class Costs:
    """What a reconstruction takes, bytes per voxel.

    Parameters
    ----------
    whole : int
        Worked in one part, at its peak.
    results : int
        Of the whole box, when worked in parts.
    part : int
        Of a part beside that.
    parts : bool
        Whether it can be worked in parts.
    """

    whole: int
    results: int
    part: int
    parts: bool = True


def memory_to_use(asked: int | None) -> int | None:
    """Bytes that a reconstruction may take: as asked, else `PART_OF_FREE` of what is free; None where the system does not tell."""
    if asked is not None:
        return asked
    free = available_memory()
    return None if free is None else int(PART_OF_FREE * free)


def cut_into_parts(grid: VoxelGrid, costs: Costs, memory: int | None) -> list[Planes]:
    """The parts in which to work a box: one where it fits into `memory` bytes (None: any number), else as few as do, alike in size.

    Raises InsufficientMemoryError when the results and one plane do not fit.
    """
    planes, plane = grid.size[2], grid.size[0] * grid.size[1]
    most = MAXIMUM_VOXELS // plane
    if (memory is None or grid.voxels * costs.whole <= memory) and planes <= most:
        return [(0, planes)]
    usable = None if memory is None else round(memory / SAFETY)
    if not costs.parts or most < 1:
        require_memory(grid.size, grid.spacing, costs.whole, usable)
    if memory is not None:
        most = min((memory - grid.voxels * costs.results) // (plane * costs.part), most)
    if most < 1:
        # What one plane takes beside the results, as if all planes did
        require_memory(grid.size, grid.spacing, costs.results + math.ceil(costs.part / planes), usable, most=LARGEST_GRID)
    count = math.ceil(planes / max(most, 1))
    return [(number * planes // count, (number + 1) * planes // count) for number in range(count)]


def frames_of(planes: Planes, reached: Mapping[int, Planes]) -> frozenset[int]:
    """Numbers of the frames that may have a pixel in planes [first, stop), by the lowest and highest plane that each has `reached`."""
    first, stop = planes
    return frozenset(number for number, (low, high) in reached.items() if low < stop and high >= first)
