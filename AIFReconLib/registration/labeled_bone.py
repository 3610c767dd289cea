"""The bone of a placed CT as methods want it: a map of the width that was asked for, or of one by how well CT and sweep agree."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from ..arrays import Matrix
from ..bone.map import BoneMap
from ..bone.widths import SIGMA_VOXELS, UNKNOWN_WIDTH
from ..compounding.methods.table import method_named
from ..errors import SettingsError
from ..geometry.labels import Labels
from ..geometry.transforms import LPS_FROM_RAS
from ..geometry.volume import Volume
from ..message import Described
from ..progress import Progress, part
from ..recipe.recipe import AUTOMATIC, Recipe
from ..sweep.frames import TrackedSequence
from .agreement import Comparison
from .comparison import compared


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
        Its `bone_sigma_voxels` and `bone_sigma_mm` are the width of the map, as in `BoneMap.from_labels`, or "auto": by how well CT and
        sweep agree. With neither it is "auto" for `weighted`, and the paper's 10 voxels for the paper's methods and one's own. What the
        probability is multiplied with, `bone_belief`, is 1, and where the width is "auto" it follows from that: see `Agreement`.

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
        self._recipe = recipe = recipe or Recipe()
        if recipe.bone_belief is not None and not 0 < recipe.bone_belief <= 1:
            raise SettingsError(f"Input bone_belief must be above 0 and at most 1; got {recipe.bone_belief!r}.")
        given = labels if isinstance(labels, Labels) else Labels(labels.array, labels.ijk_to_reference)
        if given.space_is_guessed and sequence is not None:
            given = _told_by_the_sweep(given, labels_to_reference, sequence, recipe)
        self.labels, self.labels_to_reference, self._belief = given, labels_to_reference, recipe.bone_belief
        self._sequence, self._sigma_voxels, self._sigma_mm = sequence, recipe.bone_sigma_voxels, recipe.bone_sigma_mm
        self._comparison: Comparison | None = None
        self._last: tuple[dict[str, float], BoneMap] | None = None

    def _facts(self) -> list[tuple[str, str]]:
        place = "in Reference" if self.labels_to_reference is None else "by its transform"
        return [("labels", self.labels.in_words()), ("placed", place)]

    def of_sweep(self, sequence: TrackedSequence, recipe: Recipe) -> LabeledBone:
        """The same for this sweep and recipe, where it knows no sweep yet."""
        return self if self._sequence is not None else LabeledBone(self.labels, self.labels_to_reference, sequence, recipe)

    def in_reference(self) -> Labels:
        """The labels where they lie in Reference."""
        return self.labels if self.labels_to_reference is None else self.labels.placed_by(self.labels_to_reference)

    def is_automatic(self, method: str) -> bool:
        """Whether the width follows from how well CT and sweep agree."""
        if self._sigma_mm is not None or self._sigma_voxels is not None:
            return self._sigma_mm == AUTOMATIC
        return method_named(method).follows_agreement

    def settings(self, method: str, progress: Progress | None = None) -> dict[str, float]:
        """Width of the map for a method and, where it is not 1, its belief, by the names of the options that repeat it."""
        belief = {} if self._belief is None else {"bone_belief": self._belief}
        if self.is_automatic(method):
            comparison = self.comparison(progress)
            agreement = None if comparison is None else comparison.agreement
            if agreement is None:
                return {"bone_sigma_mm": UNKNOWN_WIDTH, **belief}
            if self._belief is None and agreement.bone_belief < 1:
                belief = {"bone_belief": agreement.bone_belief}
            return {"bone_sigma_mm": agreement.bone_width, **belief}
        return {**self._given_width(), **belief}

    def _given_width(self) -> dict[str, float]:
        if isinstance(self._sigma_mm, int | float):
            return {"bone_sigma_mm": float(self._sigma_mm)}
        return {"bone_sigma_voxels": SIGMA_VOXELS if self._sigma_voxels is None else self._sigma_voxels}

    def map(self, method: str, progress: Progress | None = None) -> BoneMap:
        """The bone map for a method; the last one is kept."""
        settings = self.settings(method, part(progress, 0.0, 0.5))
        if self._last is None or self._last[0] != settings:
            voxels, mm = settings.get("bone_sigma_voxels", SIGMA_VOXELS), settings.get("bone_sigma_mm")
            # Gone before the next is made: each may be as large as the CT
            self._last = None
            made = BoneMap.from_labels(self.labels, voxels, mm, self.labels_to_reference, part(progress, 0.5, 1.0))
            if "bone_belief" in settings:
                np.multiply(made.probability.array, np.float32(settings["bone_belief"]), out=made.probability.array)
            self._last = settings, made
        return self._last[1]

    def comparison(self, progress: Progress | None = None) -> Comparison | None:
        """How CT and sweep agree, looked at once; None without a sweep."""
        if self._comparison is None and self._sequence is not None:
            placed = np.eye(4) if self.labels_to_reference is None else self.labels_to_reference
            self._comparison = compared(self._sequence, self.labels, placed, self._recipe, progress)
        return self._comparison

    def lines(self, method: str, progress: Progress | None = None) -> list[str]:
        """How CT and sweep agree, and the width that was chosen by it: a line each."""
        comparison = self.comparison(progress)
        lines = [] if comparison is None else list(comparison.lines)
        if not self.is_automatic(method):
            return lines
        width = self.settings(method)["bone_sigma_mm"]
        if comparison is None or comparison.agreement is None:
            return [*lines, f"Tolerance around the CT's bone: {width:g} mm, as CT and sweep were not compared."]
        width_line = f"Tolerance around the CT's bone: {width:g} mm, by how far the echoes lie from it."
        belief = self.settings(method).get("bone_belief", 1.0)
        if belief == 1.0:
            return [*lines, width_line]
        return [*lines, width_line, f"CT and sweep do not fit closely, so the CT's bone counts for {belief:.0%} only."]


def _told_by_the_sweep(
    labels: Labels, labels_to_reference: Matrix | None, sequence: TrackedSequence | Iterable[TrackedSequence], recipe: Recipe
) -> Labels:
    """Labels of models that may be in RAS or in LPS, in that of both in which more echoes of the sweep agree."""
    placed = np.eye(4) if labels_to_reference is None else labels_to_reference
    turned = replace(labels, ijk_to_reference=LPS_FROM_RAS @ labels.ijk_to_reference)
    agreements = [compared(sequence, each, placed, recipe).agreement for each in (labels, turned)]
    as_lps, as_ras = (0.0 if each is None else each.explained for each in agreements)
    if as_lps == as_ras:
        return labels
    chosen, name, share = (turned, "RAS", as_ras) if as_ras > as_lps else (labels, "LPS", as_lps)
    note = (
        f"The model does not say whether it is in RAS or LPS; it is taken to be in {name}, where {share:.0%} of the sweep's echoes agree."
    )
    return replace(chosen, notes=(*labels.notes[:-1], note), space_is_guessed=False)
