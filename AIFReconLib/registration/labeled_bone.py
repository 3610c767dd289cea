"""The bone of a placed CT as methods want it: a map of the width that was asked for, or of one by how well CT and sweep agree."""

from __future__ import annotations

import copy
from collections.abc import Iterable
from dataclasses import replace
from functools import cached_property

import numpy as np

from ..arrays import Floats, Mask, Matrix
from ..bone.echoes.surface import bone_from_sweep
from ..bone.field import BoneField
from ..bone.map import BoneMap
from ..bone.widths import SIGMA_VOXELS, UNKNOWN_WIDTH
from ..compounding.methods.table import is_own_method, method_named
from ..errors import GeometryError, SettingsError, require_kind
from ..geometry.labels import Labels
from ..geometry.transforms import as_matrix, invert, transform_points, why_not_rigid
from ..geometry.volume import Volume
from ..message import Described, Sentence, message_of
from ..progress import Progress, part
from ..recipe.recipe import AUTOMATIC, OF_LABELS, Recipe
from ..sweep.frames import TrackedSequence
from ..sweep.multi_sweep import sweeps_of
from .agreement import Agreement, Comparison
from .comparison import compared

PAPERS_WIDTH = Sentence(
    f"The bone map is {SIGMA_VOXELS:g} voxels of the labels wide, as the paper has it.",
    "{bone_sigma_mm:auto} finds the width by how well CT and sweep agree, as for weighted.",
)
"""Of a method of one's own."""


class LabeledBone(Described):
    """Labels with their place, and the bone maps that are made of them.

    It can be given to `reconstruct` as it is, which then chooses the width of the map by how well CT and sweep agree, and says it.

    Parameters
    ----------
    labels : Labels, or Volume of integers
        Models that do not say whether they are in RAS or LPS are placed as the sweep tells.
    labels_to_reference : (4, 4) array or None, mm
        Rigid; None where they lie in Reference already.
    sequence : TrackedSequence, several, or None
        What is reconstructed; None where it is still to come.
    recipe : Recipe or None
        `bone_sigma_mm` is the width of the map, or "auto": by how well CT and sweep agree, the default of `weighted`. Its map is
        `BoneMap.from_field`; that of the paper's methods, of one's own, and of `bone_sigma_voxels` is `BoneMap.from_labels`, by default
        the paper's 10 voxels wide. What the probability is multiplied with, `bone_belief`, is 1, and where the width is "auto" it follows
        from that: see `Agreement`. Where the CT lies far from the echoes, the map of `weighted` is `bone_from_sweep`.

    Raises
    ------
    SettingsError
        When the belief is out of range.
    """

    def __init__(
        self,
        labels: Volume,
        labels_to_reference: Matrix | None = None,
        sequence: TrackedSequence | Iterable[TrackedSequence] | None = None,
        recipe: Recipe | None = None,
    ):
        require_kind("labels", labels, Volume, "Read it first: read_labels(path); of an array make one: Volume(array, ijk_to_reference).")
        labels_to_reference = None if labels_to_reference is None else as_matrix(labels_to_reference, "labels_to_reference")
        if labels_to_reference is not None and (problem := why_not_rigid(labels_to_reference)):
            raise GeometryError(f"Input labels_to_reference must be a rotation and a translation, in mm; it is {problem}.")
        self._recipe = recipe = recipe or Recipe()
        if recipe.bone_belief is not None and not 0 < recipe.bone_belief <= 1:
            raise SettingsError(f"Input bone_belief must be above 0 and at most 1; got {recipe.bone_belief!r}.")
        sequence = None if sequence is None else sweeps_of(sequence)
        given = labels if isinstance(labels, Labels) else Labels(labels.array, labels.ijk_to_reference)
        if given.space_is_guessed and sequence is not None:
            given = _told_by_the_sweep(given, labels_to_reference, sequence, recipe)
        self.labels, self.labels_to_reference, self._belief = given, labels_to_reference, recipe.bone_belief
        self._sequence, self._sigma_voxels, self._sigma_mm = sequence, recipe.bone_sigma_voxels, recipe.bone_sigma_mm
        self._comparison: Comparison | None = None
        self._last: tuple[tuple[dict[str, float | str], bool], BoneMap] | None = None

    def _facts(self) -> list[tuple[str, str]]:
        place = "in Reference" if self.labels_to_reference is None else "by its transform"
        return [("labels", self.labels.in_words()), ("placed", place)]

    def of_sweep(self, sequence: TrackedSequence, recipe: Recipe) -> LabeledBone:
        """The same for this sweep and recipe, where it knows no sweep yet; what its own recipe says of labels comes first."""
        if self._sequence is not None:
            return self
        return LabeledBone(self.labels, self.labels_to_reference, sequence, replace(recipe, **self._recipe.given(*OF_LABELS)))

    def seen_by(self, sequence: TrackedSequence) -> LabeledBone:
        """The same beside another recording of the same scan: where the motion of the patient was taken out of it."""
        other = copy.copy(self)
        other._sequence, other._comparison, other._last = sweeps_of(sequence), None, None
        return other

    @property
    def place(self) -> Matrix:
        """labels_to_reference, (4, 4) in mm, where none is given too."""
        return np.eye(4) if self.labels_to_reference is None else self.labels_to_reference

    def in_reference(self) -> Labels:
        """The labels where they lie in Reference."""
        return self.labels.placed_by(self.labels_to_reference)

    def is_automatic(self, method: str) -> bool:
        """Whether the width follows from how well CT and sweep agree."""
        if self._sigma_mm is not None or self._sigma_voxels is not None:
            return self._sigma_mm == AUTOMATIC
        return method_named(method).follows_agreement

    def taken_from_echoes(self, method: str, progress: Progress | None = None) -> bool:
        """Whether bone is taken from the sweep's own echoes, because the CT does not lie on them."""
        if not (method_named(method).follows_agreement and self.is_automatic(method)):
            return False
        agreement = self._agreement(progress)
        return agreement is not None and agreement.misplaced

    def settings(self, method: str, progress: Progress | None = None) -> dict[str, float | str]:
        """Width of the map for a method and, where it is not 1, its belief, by the names of the options that repeat it."""
        if self.taken_from_echoes(method, progress):
            return {"bone_sigma_mm": AUTOMATIC}
        belief: dict[str, float | str] = {} if self._belief is None else {"bone_belief": self._belief}
        if self.is_automatic(method):
            agreement = self._agreement(progress)
            if agreement is None:
                return {"bone_sigma_mm": UNKNOWN_WIDTH, **belief}
            if self._belief is None and agreement.bone_belief < 1:
                belief = {"bone_belief": agreement.bone_belief}
            return {"bone_sigma_mm": agreement.bone_width, **belief}
        if isinstance(self._sigma_mm, int | float):
            return {"bone_sigma_mm": float(self._sigma_mm), **belief}
        return {"bone_sigma_voxels": SIGMA_VOXELS if self._sigma_voxels is None else self._sigma_voxels, **belief}

    def map(self, method: str, progress: Progress | None = None) -> BoneMap:
        """The bone map for a method; the last one is kept."""
        settings = self.settings(method, part(progress, 0.0, 0.5))
        # Of one width there are two kinds
        kind = settings, method_named(method).follows_agreement
        if self._last is None or self._last[0] != kind:
            # Gone before the next is made: each may be as large as the CT
            self._last = None
            made = self._made(method, settings, part(progress, 0.5, 1.0))
            if "bone_belief" in settings:
                np.multiply(made.probability.array, np.float32(settings["bone_belief"]), out=made.probability.array)
            self._last = kind, replace(made, made=settings)
        return self._last[1]

    def _made(self, method: str, settings: dict[str, float | str], progress: Progress | None) -> BoneMap:
        if self._sequence is not None and self.taken_from_echoes(method):
            try:
                return bone_from_sweep(self._sequence, self._recipe, progress, may_be=self._may_be)
            except GeometryError as none:  # a sweep that shows no bone is not a reason to make no volume
                nothing = np.zeros(self.labels.array.shape, np.uint8)
                place = self.in_reference().ijk_to_reference
                return BoneMap(Volume(nothing.astype(np.float32), place), Volume(nothing, place), (message_of(none),))
        voxels, mm = (None if name not in settings else float(settings[name]) for name in ("bone_sigma_voxels", "bone_sigma_mm"))
        if mm is not None and method_named(method).follows_agreement:
            return BoneMap.from_field(self.field, mm, self.labels_to_reference)
        return BoneMap.from_labels(self.labels, SIGMA_VOXELS if voxels is None else voxels, mm, self.labels_to_reference, progress)

    def _may_be(self, points: Floats) -> Mask:
        """Which points (n, 3) in Reference are as near to the CT's bone, misplaced as it is, as its echoes are."""
        agreement = self._agreement()
        in_labels = points if self.labels_to_reference is None else transform_points(invert(self.labels_to_reference), points)
        return np.abs(self.field.distances(in_labels)) <= (np.inf if agreement is None else agreement.reach)

    @cached_property
    def field(self) -> BoneField:
        """How far from the bone a place is, measured once: for the map, for how CT and sweep agree, and for the motion."""
        return BoneField.from_labels(self.labels)

    def comparison(self, progress: Progress | None = None) -> Comparison | None:
        """How CT and sweep agree, looked at once; None without a sweep."""
        if self._comparison is None and self._sequence is not None:
            self._comparison = compared(self._sequence, self.labels, self.place, self._recipe, progress, lambda: self.field)
        return self._comparison

    def _agreement(self, progress: Progress | None = None) -> Agreement | None:
        comparison = self.comparison(progress)
        return None if comparison is None else comparison.agreement

    def lines(self, method: str, progress: Progress | None = None) -> list[str]:
        """How CT and sweep agree, and the width that was chosen by it: a line each."""
        comparison = self.comparison(progress)
        lines = [] if comparison is None else list(comparison.lines)
        if not self.is_automatic(method):
            unasked = self._sigma_mm is None and self._sigma_voxels is None
            own = is_own_method(method) and method_named(method).needs_bone
            return [*lines, PAPERS_WIDTH] if unasked and own else lines
        if self.taken_from_echoes(method):
            return [*lines, "Bone is taken from the sweep's own echoes, as the CT does not lie on them."]
        width = self.settings(method)["bone_sigma_mm"]
        if self._agreement() is None:
            return [*lines, f"Up to {width:g} mm beside the CT's bone is taken for bone, as CT and sweep were not compared."]
        width_line = f"The echoes lie up to {width:g} mm off the CT's bone; so far beside it bone is taken for bone."
        belief = self.settings(method).get("bone_belief", 1.0)
        if belief == 1.0:
            return [*lines, width_line]
        return [*lines, width_line, f"CT and sweep do not fit closely, so the CT's bone counts for {belief:.0%} only."]


def _told_by_the_sweep(
    labels: Labels, labels_to_reference: Matrix | None, sequence: TrackedSequence | Iterable[TrackedSequence], recipe: Recipe
) -> Labels:
    """Labels of models that may be in RAS or in LPS, in that of both in which more echoes of the sweep agree."""
    placed = np.eye(4) if labels_to_reference is None else labels_to_reference
    agreements = [compared(sequence, labels.taken_as(space, "to compare"), placed, recipe).agreement for space in ("LPS", "RAS")]
    as_lps, as_ras = (0.0 if each is None else each.explained for each in agreements)
    if as_lps == as_ras:
        return labels
    space, share = ("RAS", as_ras) if as_ras > as_lps else ("LPS", as_lps)
    return labels.taken_as(space, f"where {share:.0%} of the sweep's echoes agree")
