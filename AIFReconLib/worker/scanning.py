"""What a window is told of a live scan: plain values, which need nothing that computes."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from ..arrays import Floats
from ..compounding.state import Reconstruction
from ..geometry.volume import VoxelGrid
from ..live.pairing.synchronizer import LiveFrame
from ..live.session.statistics import ALL, LiveStatistics, Spans

if TYPE_CHECKING:
    from ..guidance.snapshot import GuidanceSnapshot


@dataclass(frozen=True, eq=False)
class Seen:
    """A look at a scan.

    Parameters
    ----------
    grid : VoxelGrid or None
        The voxels that are or will be filled.
    scouted : int
        Tracked frames seen since scouting began.
    spans : Spans
        What of the recording is in the volume.
    frame : LiveFrame or None
        The newest, where it has image and pose and was not seen yet.
    result : Reconstruction or None
        The volume, where it has changed.
    guidance : GuidanceSeen or None
        Where it has changed.
    has_fallen : bool
        CT and patient agreed in this scan and do so no longer.
    agreement : str
        How well they agree; empty while that cannot be told.
    compared : int
        Number of the last frame that this was told by; -1 before the first.
    bone_lines : tuple of str
        How the search for bone in the frames goes.
    problems : tuple of str
        What is wrong beside the stream, the worst first.
    record : Path or None
        Where every frame is recorded.
    recorded, predictions : Path or None
        Of a scan that has ended: the files of frames and of what a network said.
    skin : (n, 3) array or None, mm in Reference
        Where the face of the probe was; None where that is not known.
    """

    statistics: LiveStatistics
    grid: VoxelGrid | None = None
    scouted: int = 0
    spans: Spans = ALL
    frame: LiveFrame | None = None
    result: Reconstruction | None = None
    guidance: GuidanceSnapshot | None = None
    has_fallen: bool = False
    agreement: str = ""
    compared: int = -1
    bone_lines: tuple[str, ...] = ()
    problems: tuple[str, ...] = ()
    record: Path | None = None
    recorded: Path | None = None
    predictions: Path | None = None
    skin: Floats | None = None

    @property
    def is_scouting(self) -> bool:
        """Whether the box is still to be found."""
        return self.grid is None or self.statistics.phase == "scouting"


def shown_of(result: Reconstruction, keep: Collection[str] = ()) -> Reconstruction:
    """A result without the volumes that nobody wants beside intensity and mask."""
    unwanted: dict[str, None] = dict.fromkeys({"score", "hits", "cosine"}.difference(keep))
    return replace(result, **unwanted)  # type: ignore[arg-type]
