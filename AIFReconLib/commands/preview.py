"""`aifrecon preview`: a look at a volume, as a picture; and what `reconstruct` and `live` need to draw the same."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path
from typing import ClassVar

from ..arrays import Matrix
from ..compounding.state import Reconstruction
from ..errors import GeometryError, SettingsError
from ..evaluation.preview import preview
from ..geometry.labels import Labels
from ..geometry.volume import Volume
from ..io.volume.dicom_series import read_ct
from ..io.volume.files import read_volume
from ..message import Sentence
from ..provenance.record import unlike_inputs
from ..remedies import PLACE_THE_CT
from ..sweep.poses import SweepPoses
from ..terminal.arguments import Names, Output, given_words
from ..terminal.console import ProgressBar, command_line
from ..terminal.labels_options import PlacedLabelsOptions, labels_from, labels_inputs, names_labels, place_from
from ..terminal.outputs import tell
from ..terminal.reconstruction_options import ReconstructionOptions


class _PreviewOptions(PlacedLabelsOptions):
    """Draw axial, sagittal and coronal cuts through the middle of the bone, the patient's right on the left as in Slicer, and the bone
    from the probe's side. Without labels or a CT nothing tells how the patient lies: cuts then go across x, y and z.

    Parameters
    ----------
    volume : VOLUME
        a reconstruction
    output : FILE.png
        where to draw
    mask : MASK
        0 where nothing was scanned (default: where the volume is 0)
    """

    volume: Path
    output: Output
    mask: Path | None = None

    WORDS: ClassVar[Names] = ("volume",)


def run(asked: _PreviewOptions) -> None:
    """Read, draw, write."""
    if asked.bone_transform and not (asked.bone_labels or asked.ct):
        raise SettingsError("--bone-transform places labels or a CT, and there are none. Give --bone-labels or --ct.")
    with ProgressBar() as progress:
        progress(0.0, f"Reading {asked.volume.name}")
        volume = read_volume(asked.volume)
        mask = read_volume(asked.mask) if asked.mask else None
        if mask is not None and not mask.grid.matches(volume.grid):
            raise GeometryError(f"{asked.mask}: must have the voxels of {asked.volume}. Give its own mask.")
        given, place = labels_from(asked, progress), place_from(asked)
        if given is not None:
            given = _in_sight(given, volume, place)
        labels = None if given is None else given.placed_by(place)
        ct = read_ct(asked.ct).placed_by(place) if asked.ct else None
        doubts = unlike_inputs({asked.volume.name: volume.fields}, [*labels_inputs(asked), asked.bone_transform])
        progress(0.5, "Drawing")
        preview(volume, mask, labels, ct, asked.volume.name).write(asked.output)
    tell(f"wrote {asked.output}", [*doubts, *(() if given is None else given.notes)])


def _in_sight(labels: Labels, volume: Volume, place: Matrix | None) -> Labels:
    """The labels in the space in which the volume shows them, with a warning where it shows none."""
    labels = labels.told_by(volume.grid, place)
    if labels.share_within(volume.grid, place):
        return labels
    return replace(labels, notes=(*labels.notes, Sentence("WARNING: None of the bone lies in the volume.", PLACE_THE_CT)))


def write_preview(
    result: Reconstruction, asked: ReconstructionOptions, name: str, labels: Volume | None, poses: SweepPoses | None = None
) -> list[Path]:
    """Draw what --preview asks for, with labels in Reference, else as seen from where the probe was; the answer is the file, if any."""
    if not asked.preview:
        return []
    title = f"{name}: {result.method}, {result.frames_inserted} frames"
    # Rows of an image run away from the probe
    beam = None if poses is None or labels is not None else poses.image_to_reference[poses.usable, :3, 1].mean(axis=0)
    preview(result.intensity, result.mask, labels, title=title, score=result.score, beam=beam).write(asked.preview)
    return [asked.preview]


def how_to_look(asked: ReconstructionOptions, output: Path) -> list[str]:
    """The line that says how to see what was written; none where no one reads it, or where it was drawn already."""
    if asked.preview or not sys.stdout.isatty():
        return []
    of_bone = given_words(asked, PlacedLabelsOptions) if names_labels(asked) else []
    picture = output.with_name(output.name.partition(".")[0] + ".png")
    return [f"to look at it: {command_line(['preview', str(output), *of_bone, '--output', str(picture)])}"]
