"""Free paths as a program with windows asks for them: they stay where they were found, and what is shown of them goes back.

What computes is imported where it is used: who asks does not load it.
"""

from __future__ import annotations

from dataclasses import dataclass

from ..arrays import Bytes, Floats, Integers, Matrix
from ..geometry.labels import Labels
from ..geometry.volume import Volume
from ..progress import Progress
from ..recipe.recipe import Recipe
from ..sweep.frames import TrackedSequence
from .states import MetLine


@dataclass(frozen=True, eq=False)
class _ShownPaths:
    """What is shown of paths: points in Reference, mm."""

    lines: tuple[MetLine, ...]  #: The best of each window: free ones, the widest clearance first, then those that were not seen
    skin: Floats  #: (n, 3)
    triangles: Integers  #: (m, 3), numbers of those points, counterclockwise seen from outside
    states: Bytes  #: (n,). Of the best line from each of them.
    notes: tuple[str, ...]  #: What must be known of it, but for that it is research
    unseen: Floats  #: (n, 3). As `FreePaths.unseen`: where guidance can lead the next scan.


class PathQuery:
    """Free paths in a volume; the arguments are those of `free_paths`."""

    def __init__(
        self,
        volume: Volume,
        mask: Volume | None,
        score: Volume | None,
        target: str | Floats,
        skin: TrackedSequence | Floats,
        labels: Labels | None,
        labels_to_reference: Matrix | None,
        recipe: Recipe,
        progress: Progress | None = None,
    ):
        from .free_paths import free_paths

        self._found = free_paths(
            volume, target, skin, labels, labels_to_reference, mask=mask, score=score, recipe=recipe, progress=progress
        )

    def shown(self) -> _ShownPaths:
        """What is shown of them."""
        from .path_export import skin_triangles

        found = self._found
        lines = tuple(MetLine(one.entry, one.end, one.clearance, one.seen) for one in found.windows)
        return _ShownPaths(lines, found.entries, skin_triangles(found.entries, found.target), found.states, found.notes[1:], found.unseen)

    def along(self, entry: Floats, end: Floats) -> MetLine:
        """Any other line, (3,) and (3,) mm: fast enough for one that is dragged."""
        return MetLine(entry, end, *self._found.along(entry, end))
