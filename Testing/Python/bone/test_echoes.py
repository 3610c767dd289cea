"""The echoes that a CT is laid upon: fewer of them evenly in space, and the same ones whoever looks for them."""

from __future__ import annotations

import numpy as np

from AIFReconLib.bone.echoes import search as echo_search
from AIFReconLib.bone.echoes.search import sweep_echoes
from AIFReconLib.io.sequence.files import read_sequence
from AIFReconLib.workflows.simulate import write_simulated_patient


def test_one_core_and_many_find_the_same_echoes_in_the_same_order(tmp_path, monkeypatch):
    patient = write_simulated_patient(tmp_path, 0, "multi-angle", 20)
    found = []
    for cores in (1, 3):
        monkeypatch.setattr(echo_search, "usable_cores", lambda cores=cores: cores)
        found.append(sweep_echoes(read_sequence(patient.sequence, config=patient.configuration)))
    for name in ("points", "beams", "scores", "frames"):
        np.testing.assert_array_equal(getattr(found[0], name), getattr(found[1], name))
    assert len(np.unique(found[0].frames)) > 15
