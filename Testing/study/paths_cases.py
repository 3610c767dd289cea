"""One patient of real shape of the study of free paths: a fixed scan and a planned one, the CT laid by `register`, laid wrong, and none."""

from __future__ import annotations

import warnings
from dataclasses import dataclass

import numpy as np

from AIFReconLib.bone.echoes.surface import bone_from_sweep
from AIFReconLib.bone.field import BoneField
from AIFReconLib.bone.map import BoneMap
from AIFReconLib.compounding.state import Reconstruction
from AIFReconLib.errors import DisagreementWarning
from AIFReconLib.evaluation.lines import StraightLines, points_along
from AIFReconLib.evaluation.surface import bone_surface, distance_from_labels
from AIFReconLib.evaluation.visibility import REACHED, SHADOWED, SweepBeams, look
from AIFReconLib.geometry.transforms import transform_points
from AIFReconLib.geometry.volume import Volume
from AIFReconLib.guidance.plan import plan_scan
from AIFReconLib.paths.aims import skin_under
from AIFReconLib.paths.free_paths import MARGIN
from AIFReconLib.paths.surroundings import UNDER_SKIN, PlacedField, ShownVolume, Surroundings
from AIFReconLib.recipe.recipe import ReconstructionSettings
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

SPACING = 0.7
"""mm. Gaps are filled as shipped."""

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
    shadowed: list[float]  #: Share that lay in beams, but in shadow only
    brightest: list[float]  #: Gray level
    clearance: list[float]  #: mm, of the volume's bone alone; of the CT alone
    with_ct: list[float]  #: mm, beside the CT's bone
    seen: list[float]  #: Share of the line, as the product tells it


def patient_rows(seed: int) -> list[Row]:
    """Everything of one patient."""
    back = lumbar_shapes(seed + 1)
    case = ScannedCase(seed, back)
    lines = lines_to_canal(back, back.labels, back.bone_distance, seed)
    asked = lines.free | lines.blocked
    lines = StraightLines(lines.entries[asked], lines.ends[asked], lines.nearest_bone[asked])
    plan = plan_scan(case.bone, case.probe, "interspinous", FRAMES)
    paths = {FIXED: multi_angle_sweep(back, FRAMES), PLANNED: case.path(case.missed(plan))}
    rows = []
    for scan, path in paths.items():
        probe = PhasedArray()
        sequence = configured(simulate_sweep(back, probe, path, effects=EFFECTS, seed=seed), probe)
        rows += _Scanned(seed, scan, sequence, back.labels, back.bone_distance, lines).rows()
    return rows


class _Scanned:
    """A scan of a patient, and what is made of it."""

    def __init__(self, seed: int, scan: str, sequence: TrackedSequence, labels: Volume, distance: Volume, lines: StraightLines):
        self.seed, self.scan, self.sequence, self.labels, self.lines = seed, scan, sequence, labels, lines
        self._surface = bone_surface(distance, pitch=3.0).points_reference
        status, _ = look(points_under_skin(lines).reshape(-1, 3), SweepBeams.of_sequence(sequence, thickness=BEAM_THICKNESS), distance)
        status = status.reshape(len(lines.entries), -1)
        self.reached, self.shadowed = (status == REACHED).mean(axis=1), (status == SHADOWED).mean(axis=1)
        self.skin = skin_under(sequence)

    def rows(self) -> list[Row]:
        """Every method and place of the CT."""
        rng = np.random.default_rng([self.seed, 80])
        middle = self._surface.mean(axis=0)
        found = register(self.sequence, self.labels, random_rigid(START_MM, START_DEG, rng, middle))
        wrong = random_rigid(WRONG_MM, 0.0, rng, middle)
        rows = [self.volume(NONE, PLAIN, None, None), self.volume(NONE, OURS, bone_from_sweep(self.sequence), None)]
        for ct, place, accepted in ((RIGHT, found.transform, found.accepted), (WRONG, wrong, False)):
            rows.append(self.volume(ct, OURS, LabeledBone(self.labels, place, self.sequence), place, accepted))
            rows.append(self.ct_alone(ct, place, accepted))
        return rows

    def volume(self, ct: str, method: str, bone: BoneMap | LabeledBone | None, place: np.ndarray | None, accepted: bool = False) -> Row:
        """What the product says of a reconstruction."""
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DisagreementWarning)
            result = reconstruct(self.sequence, ReconstructionSettings(method=method, spacing=SPACING), bone)
        judged = judged_by_product(result, self.skin, self.lines, self.labels, place)
        return self._row(ct, method, place, accepted, brightest=rounded(self.lines.brightest(result.intensity)), **judged)

    def ct_alone(self, ct: str, place: np.ndarray, accepted: bool) -> Row:
        """What the CT says without any scan."""
        distance = distance_from_labels(self.labels.placed_by(place))
        alone = StraightLines.past(distance, self.lines.entries, self.lines.ends)
        return self._row(ct, "", place, accepted, clearance=rounded(alone.nearest_bone))

    def _row(self, ct: str, method: str, place: np.ndarray | None, accepted: bool, **told) -> Row:
        off = np.nan
        if place is not None:
            off = float(np.linalg.norm(transform_points(place, self._surface) - self._surface, axis=1).mean())
        nothing = {"agrees": False, "margin": 0.0, "brightest": [], "with_ct": [], "seen": []}
        geometry = rounded(self.lines.nearest_bone), rounded(self.reached), rounded(self.shadowed)
        return Row(
            self.seed,
            self.scan,
            ct,
            method,
            len(self.sequence),
            off,
            accepted,
            truth=geometry[0],
            reached=geometry[1],
            shadowed=geometry[2],
            **(nothing | told),
        )


def judged_by_product(
    result: Reconstruction, skin: np.ndarray, lines: StraightLines, labels: Volume, place: np.ndarray | None
) -> dict[str, object]:
    """What `free_paths` says of lines, as fields of a row; `place` is None where no CT is given."""
    shown = ShownVolume.of(result.intensity, result.mask, result.score)
    bone = shown.bone(skin)
    field = None if place is None else PlacedField(BoneField.from_labels(labels), place)
    agrees = field is not None and field.agrees(shown, bone)
    margin = MARGIN + float(result.grid.spacing.max()) / 2
    reach = np.concatenate([lines.entries, lines.ends])
    clearance, seen = Surroundings.around(shown, bone, reach, margin).along(lines.entries, lines.ends)
    told = {"agrees": agrees, "margin": margin, "clearance": rounded(clearance), "seen": rounded(seen)}
    if field is not None:
        beside = Surroundings.around(shown, bone, reach, margin, field if agrees else None)
        told["with_ct"] = rounded(beside.along(lines.entries, lines.ends)[0])
    return told


def points_under_skin(lines: StraightLines) -> np.ndarray:
    """Places of each line, (n, m, 3), but for the part next to the skin, which the product does not judge."""
    way = lines.ends - lines.entries
    first = lines.entries + UNDER_SKIN * way / np.linalg.norm(way, axis=1)[:, None]
    return points_along(first, lines.ends, LOOK)


def rounded(numbers: np.ndarray) -> list[float]:
    """As they are kept."""
    return np.round(np.asarray(numbers, dtype=np.float64), 3).tolist()
