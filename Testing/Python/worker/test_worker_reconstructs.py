"""A reconstruction in the worker is the one of the library, to the bit, with all that is shown of it."""

from __future__ import annotations

import textwrap

import numpy as np
import pytest
from sweeps import oblique_sequence, two_vertebrae

from AIFReconLib.compounding.state import BESIDE
from AIFReconLib.errors import MethodError
from AIFReconLib.inspection.tracking_report import tracking_report
from AIFReconLib.recipe.recipe import Recipe
from AIFReconLib.reconstruction import reconstruct
from AIFReconLib.registration.labeled_bone import LabeledBone
from AIFReconLib.sweep.poses import sweep_poses
from AIFReconLib.worker.reconstructing import know_method, reconstructed
from AIFReconLib.workflows.job import BoneSource, ReconstructionJob


def test_voxels_score_and_hits_are_those_of_the_library_and_the_report_is_of_the_sweep(worker):
    recipe = Recipe(spacing=1.0, probe="linear", bone_sigma_mm=2.0)
    labels, place = two_vertebrae(), np.eye(4)
    sequence = oblique_sequence()
    made = worker.call(
        reconstructed, ReconstructionJob(sequence, recipe, bone=BoneSource(labels, to_reference=place)), BESIDE, for_views=True
    )
    bone = LabeledBone(labels, place, sequence, recipe).map("weighted")
    expected = reconstruct(sequence, recipe, bone)
    for kind in ("intensity", "score", "hits", "mask"):
        np.testing.assert_array_equal(getattr(made.result, kind).array, getattr(expected, kind).array)
    mean = reconstruct(sequence, Recipe(spacing=1.0, method="average", hole_limit=expected.hole_limit), grid=expected.grid)
    np.testing.assert_array_equal(made.measured.array, mean.intensity.array)
    assert made.tracking[sequence.name] == tracking_report(sequence, sweep_poses(sequence), expected)
    assert made.comparison.lines


def test_what_is_not_wanted_stays_in_the_worker(worker):
    made = worker.call(reconstructed, ReconstructionJob(oblique_sequence(), Recipe(spacing=2.0, method="average")), for_views=True)
    assert (made.result.score, made.result.hits, made.result.cosine, made.measured, made.surface) == (None,) * 5


def test_a_method_of_one_s_own_is_imported_where_it_lies_and_anew_when_its_file_has_changed(worker, tmp_path):
    def write(level: int) -> None:
        (tmp_path / "own_level.py").write_text(
            textwrap.dedent(f"""
            from AIFReconLib import register_method

            @register_method
            def flat(intensity):
                return 1 + 0 * intensity, 0 * intensity + {level}  # {"x" * level}
            """),
            encoding="utf-8",
        )

    def brightest() -> int:
        asked = ReconstructionJob(oblique_sequence(), object.__new__(Recipe), search_path=(str(tmp_path),))
        vars(asked.recipe).update({**vars(Recipe(spacing=2.0, method="average")), "method": "own_level:flat"})
        return int(worker.call(reconstructed, asked).result.intensity.array.max())

    write(70)
    assert brightest() == 70
    write(9)
    assert brightest() == 9


def test_a_method_that_was_written_into_the_console_is_refused_in_a_sentence():
    with pytest.raises(MethodError, match=r"was written into the console\. Write it into a file"):
        know_method("__main__:flat")
