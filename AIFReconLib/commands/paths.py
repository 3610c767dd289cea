"""`aifrecon paths`: where a straight line from the skin reaches a target past the bone that a volume shows."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import ClassVar

from ..arrays import Floats
from ..errors import OutputError, SettingsError
from ..geometry.transforms import LPS_FROM_RAS, transform_points
from ..io.disk.atomic import write_text
from ..io.sequence.files import read_sequence
from ..io.volume.files import read_volume
from ..io.volume.models import LPS, MODEL_SUFFIXES, RAS, read_model
from ..paths.free_paths import MARGIN, free_paths
from ..paths.path_export import markups, paths_figure, write_skin_map
from ..progress import part
from ..sweep.frames import TrackedSequence
from ..terminal.arguments import Names, Output, is_number
from ..terminal.console import ProgressBar
from ..terminal.labels_options import PlacedLabelsOptions, labels_from, place_from
from ..terminal.outputs import tell, write_json
from ..terminal.remedies import in_options
from ..terminal.sequence_options import ImageOptions, TrackingOptions, configured

MARKUPS = ".mrk.json"


class _PathsOptions(PlacedLabelsOptions, TrackingOptions, ImageOptions):
    """Find straight lines from the skin to a target that meet no bone that a volume shows: how far each keeps from it, how much of it was
    seen, and the best one of each window. Research only.

    Parameters
    ----------
    volume : VOLUME
        a reconstructed volume
    mask : VOLUME
        0 where nothing was measured (default: where the volume is 0)
    score : VOLUME
        of the method weighted: tells what lies in the shadow of bone
    target : WHERE
        L3-L4: the canal between two labels; or X Y Z in Reference (RAS)
    sweep : SEQUENCE
        where lines begin: where the probe's face was in these sweeps; or --skin
    skin : FILE
        a surface in Reference: .stl, .ply, .obj, .vtp or .vtk
    margin : MM
        taken off each distance from bone, beside half a voxel, for calibration and registration
    output : PATHS.mrk.json
        the lines, for Slicer's markups
    skin_map : FILE.vtp
        also write the skin: blocked, not seen, tight or free
    report : FILE.json
        also write all numbers, for aifrecon plan --unseen
    preview : FILE.png
        also draw slices along the best line, and the skin

    Examples
    --------
      aifrecon paths volume.nrrd --mask mask.nrrd --score score.nrrd --target L3-L4 --bone-labels lumbar.nrrd \\
          --bone-transform CTToReference.tfm --sweep sweep.igs.mha --config PlusDeviceSet.xml --output paths.mrk.json

    Research only: not for guiding a needle. What was not seen is not called free; that needs --mask, and --score of the method weighted.
    """

    volume: Path
    mask: Path | None = None
    score: Path | None = None
    target: tuple[str, ...]
    sweep: tuple[Path, ...] = ()
    skin: Path | None = None
    margin: float = MARGIN
    output: Output
    skin_map: Output | None = None
    report: Output | None = None
    preview: Output | None = None

    WORDS: ClassVar[Names] = ("volume",)
    FIRST: ClassVar[Names] = ("bone_labels", "bone_transform", "sweep", "skin", "config", "mask", "score", "preview", "quiet")


def run(asked: _PathsOptions) -> None:
    """Read, look along the lines, write, and say what was found."""
    if not asked.output.name.lower().endswith(MARKUPS):
        raise OutputError(f"Cannot write {asked.output}: Slicer's markups end in {MARKUPS}. Choose another name.")
    if bool(asked.sweep) == bool(asked.skin):
        raise SettingsError("Where the skin is must be given, once. Give --sweep SEQUENCE, whose probe was on it, or --skin FILE.")
    target = _target(asked.target)
    with ProgressBar() as progress:
        volume = read_volume(asked.volume)
        mask, score = (read_volume(path) if path else None for path in (asked.mask, asked.score))
        placed = place_from(asked)
        labels = labels_from(asked, part(progress, 0.0, 0.2))
        labels = None if labels is None else labels.told_by(volume.grid, placed)
        recipe, rest = asked.recipe, part(progress, 0.2, 0.95)
        found = free_paths(
            volume,
            target,
            _skin(asked),
            labels,
            placed,
            mask=mask,
            score=score,
            margin=asked.margin,
            recipe=recipe,
            progress=rest,
        )
        if asked.preview:
            paths_figure(asked.preview, volume, found)
        write_text(asked.output, json.dumps(markups(found), indent=1) + "\n")
        if asked.skin_map:
            write_skin_map(asked.skin_map, found)
        write_json(asked.report, found.to_dict())
    notes = labels.notes if labels is not None else ()
    tell("\n".join(found.text(in_options)), notes, [asked.output, asked.skin_map, asked.report, asked.preview])


def _target(words: Sequence[str]) -> str | list[float]:
    """A level, or a point."""
    if len(words) == 1:
        return words[0]
    if len(words) != 3 or not all(map(is_number, words)):
        raise SettingsError(f"Input --target must be two labels as in L3-L4, or a point X Y Z in mm; got {' '.join(words)!r}.")
    return [float(word) for word in words]


def _skin(asked: _PathsOptions) -> list[TrackedSequence] | Floats:
    if not asked.skin:
        return [read_sequence(path, config=config) for path, config in configured(asked, asked.sweep)]
    if asked.skin.suffix.lower() not in MODEL_SUFFIXES:
        raise SettingsError(f"Input --skin must be a surface, {', '.join(MODEL_SUFFIXES)}; got {asked.skin.name}.")
    model = read_model(asked.skin, asked.bone_unit)
    # As Slicer does, what does not say its space is in LPS
    is_ras = (model.space or asked.bone_space or LPS).lower() == RAS.lower()
    return model.points if is_ras else transform_points(LPS_FROM_RAS, model.points)
