"""A folder of cases, as docs/cohorts.md has it."""

from __future__ import annotations

import pytest
from files import write_patient


@pytest.fixture
def lab(tmp_path):
    (tmp_path / "P1").mkdir()
    write_patient(tmp_path / "P1")
    (tmp_path / "cases.csv").write_text("case,sweeps,config,spacing,preview\nP1,P1/sweep.igs.mha,P1/PlusDeviceSet.xml,1,no\n")
    return tmp_path
