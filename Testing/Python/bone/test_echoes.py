"""The echoes that a CT is laid upon: fewer of them evenly in space, and the same ones whoever looks for them."""

from __future__ import annotations

import numpy as np
import pytest

from AIFReconLib.bone.echoes import search as echo_search
from AIFReconLib.bone.echoes.found import SweepEchoes
from AIFReconLib.bone.echoes.search import sweep_echoes
from AIFReconLib.io.sequence.files import read_sequence
from AIFReconLib.workflows.simulate import write_simulated_patient


def scattered(count=700) -> SweepEchoes:
    random = np.random.default_rng(3)
    points = random.normal((-40.0, 3.0, 900.0), 6.0, (count, 3))
    return SweepEchoes(points, np.tile([0.0, 1.0, 0.0], (count, 1)), random.integers(0, 9, count).astype(np.float32) / 8, np.arange(count))


@pytest.mark.parametrize("most", [50, 200, 699])
def test_of_the_echoes_in_a_cube_the_surest_is_kept_in_the_first_grid_that_is_coarse_enough(most):
    all_of_them, edge = scattered(), 1.0
    while True:
        best: dict = {}
        for number, (point, score) in enumerate(zip(all_of_them.points, all_of_them.scores)):
            cube = tuple(np.floor(point / edge))
            if cube not in best or score > all_of_them.scores[best[cube]]:
                best[cube] = number
        if len(best) <= most:
            break
        edge *= 1.2
    np.testing.assert_array_equal(all_of_them.thinned(most).frames, sorted(best.values()))


def test_one_core_and_many_find_the_same_echoes_in_the_same_order(tmp_path, monkeypatch):
    patient = write_simulated_patient(tmp_path, 0, "multi-angle", 20)
    found = []
    for cores in (1, 3):
        monkeypatch.setattr(echo_search, "usable_cores", lambda cores=cores: cores)
        found.append(sweep_echoes(read_sequence(patient.sequence, config=patient.configuration)))
    for name in ("points", "beams", "scores", "frames"):
        np.testing.assert_array_equal(getattr(found[0], name), getattr(found[1], name))
    assert len(np.unique(found[0].frames)) > 15
