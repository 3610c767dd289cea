"""Which straight lines from the skin reach a target past all bone that a volume shows; the best one of each window."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Bytes, Floats, Integers, Matrix
from ..bone.canal import canal_between
from ..bone.field import BoneField
from ..compounding.state import Reconstruction
from ..errors import GeometryError, SettingsError
from ..evaluation.visibility import SweepBeams
from ..geometry.box import in_cubes
from ..geometry.labels import Labels
from ..geometry.transforms import as_matrix
from ..geometry.volume import Volume
from ..message import Described, Sentence, advised, columns
from ..progress import Progress, report
from ..recipe.recipe import Recipe
from ..remedies import PLACE_THE_CT
from ..sweep.frames import TrackedSequence
from .states import FREE, NOT_SEEN, STATES, states_of
from .surroundings import PlacedField, ShownVolume, Surroundings
from .windows import END_PITCH, ENTRY_PITCH, Window, windows_of

MARGIN = 1.0
"""mm that are taken off every distance from bone beside half a voxel: registration, calibration and tracking are no better."""

WITHIN, CONE_DEG = 5.0, 30.0
"""mm from the target within which lines end, and the largest angle between a line and the shortest way from the skin to the target."""

FARTHEST = 200.0
"""mm from the skin to the target, at most."""

RESEARCH = "Research only: not for guiding a needle. Soft tissue, a skin that gives and needles that bend are not judged."


@dataclass(frozen=True, eq=False, repr=False)
class FreePaths(Described):
    """What lines from the skin to a target meet."""

    target: Floats  #: (3,), mm in Reference, as all points here
    entries: Floats  #: (n, 3). Points on the skin.
    states: Bytes  #: (n,). Of the best line from there: `BLOCKED`, `NOT_SEEN`, `TIGHT` or `FREE`; see `AIFReconLib.paths.states`.
    clearances: Floats  #: (n,), mm. Of that line: its distance from bone less the margin.
    seen: Floats  #: (n,), 0 to 1. The share of it that was seen.
    lines: int  #: How many were looked at
    windows: tuple[Window, ...]  #: Free ones, the widest clearance first, then those that were not seen
    surroundings: Surroundings
    level: float  #: The gray level from which a voxel is bone
    ct_agrees: bool | None
    """Whether the volume's bone lies on the CT's; only then the CT's bone counts, too. None without labels."""
    notes: tuple[str, ...]

    def _facts(self) -> list[tuple[str, str]]:
        return [("windows", str(sum(one.is_free for one in self.windows))), ("lines", str(self.lines)), ("entries", str(len(self.entries)))]

    @property
    def unseen(self) -> Floats:
        """(n, 3), mm: the places of windows that were not seen. `AIFReconLib.guidance.window` aims a scan at them."""
        return np.concatenate([np.empty((0, 3)), *(one.unseen for one in self.windows if not one.is_free)])

    def along(self, entry: ArrayLike, end: ArrayLike) -> tuple[float, float]:
        """Of any line, (3,) and (3,) mm: clearance in mm, and the share of it that was seen. Fast enough for a line that is dragged."""
        ends = (np.asarray(point, dtype=np.float64).reshape(1, 3) for point in (entry, end))
        clearance, seen = self.surroundings.along(*ends)
        return float(clearance[0]), float(seen[0])

    def text(self, in_words: Callable[[str], str] = advised) -> list[str]:
        """The windows as a table, with what must be known of it, remedies in the words of a terminal or another door."""
        rows = [("window", "clearance", "depth", "seen", "width", "entry (RAS, mm)")]
        rows += [
            (
                one.name if one.is_free else f"{one.name}, not seen",
                f"{one.clearance:.1f} mm" if one.is_free else "-",
                f"{one.depth:.0f} mm",
                f"{one.seen:.0%}",
                f"{one.width[0]:.0f} x {one.width[1]:.0f} mm",
                " ".join(f"{place:.1f}" for place in one.entry),
            )
            for one in self.windows
        ]
        counts = ", ".join(f"{int((self.states == n).sum())} {name}" for n, name in reversed(list(enumerate(STATES))))
        found = sum(one.is_free for one in self.windows)
        head = f"{found} free window{'s' * (found != 1)} among {self.lines} lines from {len(self.entries)} points of the skin: {counts}"
        return [head, *(columns(rows).split("\n") if self.windows else []), *(f"  {in_words(note)}" for note in self.notes)]

    def to_dict(self) -> dict[str, object]:
        """All but the map, for JSON."""
        return {
            "use": RESEARCH,
            "coordinates": "RAS, mm, in Reference",
            "target": np.round(self.target, 3).tolist(),
            "lines": self.lines,
            "entries": {name: int((self.states == n).sum()) for n, name in enumerate(STATES)},
            "margin_mm": round(self.surroundings.margin, 3),
            "bone_from_level": round(self.level, 2),
            "ct_agrees": self.ct_agrees,
            "notes": list(self.notes),
            "windows": [one.to_dict() for one in self.windows],
        }


def free_paths(
    result: Reconstruction | Volume,
    target: str | ArrayLike,
    skin: TrackedSequence | Iterable[TrackedSequence] | np.ndarray,
    labels: Volume | None = None,
    labels_to_reference: Matrix | None = None,
    *,
    mask: Volume | None = None,
    score: Volume | None = None,
    margin: float = MARGIN,
    within: float = WITHIN,
    cone_deg: float = CONE_DEG,
    recipe: Recipe | None = None,
    progress: Progress | None = None,
) -> FreePaths:
    """Which straight lines from the skin reach a target past all bone that a volume shows. Research only: not for guiding a needle.

    Raises AIFReconError when the target is not near the skin, a level is not among the labels, or the volume shows no bone.

    Parameters
    ----------
    result : Reconstruction, or Volume
        With mask and score, which a Reconstruction has: what was not measured, or lies in the shadow of bone in all frames, is not free.
    target : str, or (3,) array_like, mm
        Two labels, as "L3-L4": the middle of the canal between them; or a point in Reference.
    skin : sweep, several, or (n, 3) array, mm
        Where lines begin: where the face of the probe was, or points on the skin in Reference.
    labels : Labels, or Volume of integers, or None
        Of a CT. Its bone counts beside that of the volume, where both agree.
    labels_to_reference : (4, 4) array, mm, or None
        The registration; None where the labels lie in Reference.
    mask, score : Volume or None
        Of a Volume: see `ShownVolume.of`.
    margin : float, mm
        Taken off every distance from bone, beside half a voxel.
    within : float, mm
        How far from the target lines may end.
    cone_deg : float
        Largest angle between a line and the shortest way from the skin to the target.
    recipe : Recipe or None
        How sweeps are read.

    Notes
    -----
    Bone is what is brighter than two thirds of the way from the median of the measured voxels to their percentile 99.5, but for the 4 mm
    under the skin. A voxel was seen where pixels that sound reached, by the evidence of `weighted`, add up to one. A line is blocked where
    its distance from bone is below the margin; else not seen, where any part of it was not; else tight below 1 mm of clearance, else free.
    Windows are free lines that are neighbors on the skin or at the target.
    """
    for name, value, most in (("margin", margin, 50.0), ("within", within, 50.0), ("cone_deg", cone_deg, 80.0)):
        if not 0 <= value <= most:
            raise SettingsError(f"Input {name} must be 0 to {most:g}; got {value!r}.")
    report(progress, 0.0, "Looking for bone in the volume")
    shown = _shown(result, mask, score)
    given = None if labels is None else labels if isinstance(labels, Labels) else Labels(labels.array, labels.ijk_to_reference)
    place = np.eye(4) if labels_to_reference is None else as_matrix(labels_to_reference, "labels_to_reference")
    center = _target(target, given, place)
    points = np.asarray(skin, dtype=np.float64) if isinstance(skin, np.ndarray) else SweepBeams.of_sequence(skin, recipe).skin()
    if points.ndim != 2 or points.shape[1] != 3 or not len(points) or not np.isfinite(points).all():
        raise GeometryError(f"Input skin must be points (n, 3) in mm, or a sweep; got shape {points.shape}.")
    points = in_cubes(points, ENTRY_PITCH)[0]
    away = np.linalg.norm(points - center, axis=1)
    if not within < away.min() < FARTHEST:
        raise GeometryError(
            f"The target must lie {within:g} to {FARTHEST:g} mm under the skin; got {away.min():.0f} mm to its nearest point. Do volume, "
            "target and skin lie in one Reference?"
        )
    axis = (center - points[away.argmin()]) / away.min()
    entries, ends, number, last = _lines(points, center, axis, within, cone_deg)
    report(progress, 0.3, "Looking for bone in the volume")
    bone = shown.bone(points)
    field = None if given is None else PlacedField(BoneField.from_labels(given), place)
    agrees = None if field is None else field.agrees(shown, bone)
    whole_margin = margin + float(shown.intensity.grid.spacing.max()) / 2
    reach = np.concatenate([entries, ends])
    surroundings = Surroundings.around(shown, bone, reach, whole_margin, field if agrees else None)
    report(progress, 0.6, "Following the lines")
    clearance, seen = surroundings.along(entries[number], ends[last])
    states = states_of(clearance, seen)
    report(progress, 0.9, "Telling windows apart")
    windows = windows_of(surroundings, (entries, ends), (number, last), clearance, seen, states)
    # Of each entry the best line: by its state, then by its clearance
    order = np.lexsort((clearance, states, number))
    best = order[np.flatnonzero(np.diff(number[order], append=-1))]
    return FreePaths(
        center,
        entries,
        states[best],
        clearance[best],
        seen[best],
        len(number),
        windows,
        surroundings,
        shown.level,
        agrees,
        _notes(shown, agrees, states, whole_margin),
    )


def _shown(result: Reconstruction | Volume, mask: Volume | None, score: Volume | None) -> ShownVolume:
    if isinstance(result, Reconstruction):
        return ShownVolume.of(result.intensity, mask or result.mask, score or result.score)
    return ShownVolume.of(result, mask, score)


def _target(target: str | ArrayLike, labels: Labels | None, place: Matrix) -> Floats:
    if isinstance(target, str):
        if labels is None:
            raise SettingsError(f"Target {target} is a level, and there are no labels to find it by. Give labels, or a point X Y Z.")
        return canal_between(labels, target, place)
    center = np.asarray(target, dtype=np.float64)
    if center.shape != (3,) or not np.isfinite(center).all():
        raise SettingsError(f"Input target must be a point X Y Z in mm, or two labels as in L3-L4; got {target!r}.")
    return center


def _lines(skin: Floats, center: Floats, axis: Floats, within: float, cone_deg: float) -> tuple[Floats, Floats, Integers, Integers]:
    """Entries (n, 3) and ends (m, 3), and which of them lines join, (k,) and (k,)."""
    aside = np.linalg.svd(axis[None])[2][1:]
    steps = np.arange(-np.floor(within / END_PITCH), np.floor(within / END_PITCH) + 1) * END_PITCH
    across = np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2)
    ends = center + across[np.hypot(*across.T) <= within] @ aside
    way = ends[None] - skin[:, None]
    number, last = np.nonzero(way @ axis > np.cos(np.radians(cone_deg)) * np.linalg.norm(way, axis=2))
    kept, number = np.unique(number, return_inverse=True)
    return skin[kept], ends, number, last


def _notes(shown: ShownVolume, agrees: bool | None, states: Bytes, margin: float) -> tuple[str, ...]:
    notes = [RESEARCH, f"{margin:.1f} mm are taken off each distance from bone: registration, calibration, half a voxel."]
    if shown.looks is None:
        notes.append("Shadows are not known: that needs the score of the method weighted. A line through one may be called free.")
    if agrees is not None:
        notes.append(
            "CT and volume agree: bone is what either shows."
            if agrees
            else Sentence(
                "WARNING: the CT does not lie on the volume's bone, and the level may be a wrong one. Only the volume's bone counts: no "
                "lower bound is promised.",
                PLACE_THE_CT,
            )
        )
    if not (states == FREE).any() and (states == NOT_SEEN).any():
        notes.append("Nothing seen is free; lines that were not seen may be. Scan there.")
    return tuple(notes)
