"""One patient of real shape of the study of free paths: a fixed scan and a planned one, the CT laid by `register`, laid wrong, and none."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, replace

import numpy as np

from AIFReconLib.bone.echoes.surface import bone_from_sweep
from AIFReconLib.bone.field import BoneField
from AIFReconLib.bone.map import BoneMap
from AIFReconLib.errors import DisagreementWarning
from AIFReconLib.evaluation.lines import UNDER_SKIN, StraightLines, points_along
from AIFReconLib.evaluation.surface import bone_surface, distance_from_labels
from AIFReconLib.evaluation.visibility import REACHED, SweepBeams, look
from AIFReconLib.geometry.transforms import transform_points
from AIFReconLib.geometry.volume import Volume
from AIFReconLib.guidance.plan import plan_scan
from AIFReconLib.paths.free_paths import MARGIN
from AIFReconLib.paths.surroundings import PlacedField, ShownVolume, Surroundings
from AIFReconLib.recipe.recipe import Recipe, ReconstructionSettings
from AIFReconLib.reconstruction import reconstruct
from AIFReconLib.registration.labeled_bone import LabeledBone
from AIFReconLib.registration.registration import register
from AIFReconLib.simulation.phased_array import PhasedArray
from AIFReconLib.simulation.scan import multi_angle_sweep, random_rigid, simulate_sweep
from AIFReconLib.sweep.frames import TrackedSequence

from .free_paths import lines_to_canal
from .guidance_cases import ScannedCase
from .lumbar_shapes import lumbar_shapes
from .method_cases import BEAM_THICKNESS, EFFECTS, OURS, PLAIN, configured

FRAMES = 297
"""Of each scan; of the fixed one 33 in each of nine passes."""

SETTINGS = ReconstructionSettings(spacing=0.7)
"""mm; gaps are filled as shipped."""

START_MM, START_DEG = 5.0, 3.0
"""How far off `register` begins."""

WRONG_MM = 3.0

FIXED, PLANNED = "fixed scan", "planned scan"
RIGHT, WRONG, NONE = "right CT", "CT 3 mm off", "no CT"

LOOK = 1.5
"""mm between places at which it is asked whether a beam came there."""


@dataclass(frozen=True)
class Row:
    """What one volume, or a CT alone, says of all lines of a patient; lists have an entry for each line that is free or blocked."""

    patient: int
    scan: str
    ct: str
    method: str  #: "" of the CT alone
    frames: int
    misplaced: float  #: mm on the mean by which the CT's bone is off; NaN without one
    accepted: bool  #: By `register`
    agrees: bool  #: Whether the CT counts beside the volume's bone
    margin: float  #: mm that clearance is less than distance
    truth: list[float]  #: mm to true bone, signed
    reached: list[float]  #: Share of the line that some beam reached, by geometry
    brightest: list[float]  #: Gray level
    clearance: list[float]  #: mm, past the volume's bone alone, or past that of the CT alone
    with_ct: list[float]  #: mm, beside the CT's bone
    seen: list[float]  #: Share of the line, as the product tells it


LISTS = ("truth", "reached", "brightest", "clearance", "with_ct", "seen")


def patient_rows(seed: int) -> list[Row]:
    """Everything of one patient."""
    back = lumbar_shapes(seed + 1)
    case = ScannedCase(seed, back)
    lines = lines_to_canal(back, back.labels, back.bone_distance, seed)
    plan = plan_scan(case.bone, case.probe, "interspinous", FRAMES)
    paths = {FIXED: multi_angle_sweep(back, FRAMES), PLANNED: case.path(case.missed(plan))}
    rows = []
    for scan, path in paths.items():
        probe = PhasedArray()
        sequence = configured(simulate_sweep(back, probe, path, effects=EFFECTS, seed=seed), probe)
        rows += _every_ct(ScannedLines(seed, scan, sequence, back.labels, back.bone_distance, lines))
    return rows


def _every_ct(scanned: ScannedLines) -> list[Row]:
    """Every method and place of the CT."""
    rng = np.random.default_rng([scanned.seed, 80])
    found = register(scanned.sequence, scanned.labels, random_rigid(START_MM, START_DEG, rng, scanned.middle))
    wrong = random_rigid(WRONG_MM, 0.0, rng, scanned.middle)
    rows = [scanned.volume(NONE, PLAIN), scanned.volume(NONE, OURS)]
    for ct, place, accepted in ((RIGHT, found.transform, found.accepted), (WRONG, wrong, False)):
        rows += [scanned.volume(ct, OURS, place, accepted), scanned.ct_alone(ct, place, accepted)]
    return rows


class ScannedLines:
    """Lines of a scan that are free or blocked, and what is told of them."""

    def __init__(
        self,
        seed: int,
        scan: str,
        sequence: TrackedSequence,
        labels: Volume,
        distance: Volume,
        lines: StraightLines,
        recipe: Recipe = SETTINGS,
    ):
        self.seed, self.scan, self.sequence, self.labels, self._recipe = seed, scan, sequence, labels, recipe
        asked = lines.free | lines.blocked
        self._lines = lines = StraightLines(lines.entries[asked], lines.ends[asked], lines.nearest_bone[asked])
        self._surface = bone_surface(distance, pitch=3.0).points_reference
        beams = SweepBeams.of_sequence(sequence, recipe, BEAM_THICKNESS)
        places = points_under_skin(lines)
        status, _ = look(places.reshape(-1, 3), beams, distance)
        self._reached = (status.reshape(places.shape[:2]) == REACHED).mean(axis=1)
        self._skin = beams.skin()

    @property
    def middle(self) -> np.ndarray:
        """Of the bone, (3,) mm."""
        return self._surface.mean(axis=0)

    def volume(self, ct: str, method: str, place: np.ndarray | None = None, accepted: bool = False) -> Row:
        """What the product says of a reconstruction; `place` is that of the CT's labels, None without a CT."""
        recipe = replace(self._recipe, method=method)
        bone: BoneMap | LabeledBone | None = None
        if place is not None:
            bone = LabeledBone(self.labels, place, self.sequence, recipe)
        elif method == OURS:
            bone = bone_from_sweep(self.sequence, recipe)
        with warnings.catch_warnings():
            # Told of wrong CTs, as it should be
            warnings.simplefilter("ignore", DisagreementWarning)
            result = reconstruct(self.sequence, recipe, bone)
        shown = ShownVolume.of(result.intensity, result.mask, result.score)
        bright = shown.bone(self._skin)
        field = None if place is None else PlacedField(BoneField.from_labels(self.labels), place)
        agrees = field is not None and field.agrees(shown, bright)
        ends = self._lines.entries, self._lines.ends

        def surroundings(ct: PlacedField | None) -> Surroundings:
            return Surroundings.around(shown, bright, np.concatenate(ends), self._margin, ct)

        clearance, seen = surroundings(None).along(*ends)
        with_ct = surroundings(field).along(*ends)[0] if agrees else clearance
        brightest = self._lines.brightest(result.intensity)
        return self._row(ct, method, place, accepted, agrees, brightest=brightest, clearance=clearance, with_ct=with_ct, seen=seen)

    def ct_alone(self, ct: str, place: np.ndarray, accepted: bool = False) -> Row:
        """What the CT says without any scan."""
        distance = distance_from_labels(self.labels.placed_by(place))
        nearest = StraightLines.past(distance, self._lines.entries, self._lines.ends).nearest_bone
        return self._row(ct, "", place, accepted, clearance=nearest - self._margin)

    @property
    def _margin(self) -> float:
        return MARGIN + float(np.max(self._recipe.spacing or 0.0)) / 2

    def _row(self, ct: str, method: str, place: np.ndarray | None, accepted: bool, agrees: bool = False, **told: np.ndarray) -> Row:
        off = np.nan
        if place is not None:
            off = float(np.linalg.norm(transform_points(place, self._surface) - self._surface, axis=1).mean())
        told = {"truth": self._lines.nearest_bone, "reached": self._reached, **told}
        lists = {name: rounded(told.get(name, np.empty(0))) for name in LISTS}
        return Row(self.seed, self.scan, ct, method, len(self.sequence), off, accepted, agrees, self._margin, **lists)


def points_under_skin(lines: StraightLines) -> np.ndarray:
    """Places of each line, (n, m, 3), but for the part next to the skin, which the product does not judge."""
    way = lines.ends - lines.entries
    first = lines.entries + UNDER_SKIN * way / np.linalg.norm(way, axis=1)[:, None]
    return points_along(first, lines.ends, LOOK)


def rounded(numbers: np.ndarray) -> list[float]:
    """As they are kept."""
    return np.round(np.asarray(numbers, dtype=np.float64), 3).tolist()
