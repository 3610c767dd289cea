"""Fewer candidate passes than a probe has, so that tests are quick."""

from __future__ import annotations

import pytest

from AIFReconLib.guidance import passes


@pytest.fixture(scope="package", autouse=True)
def few_candidates():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(passes, "SAGITTAL_TILTS_DEG", (-38.0, 0.0, 38.0))
        patch.setattr(passes, "SAGITTAL_ACROSS_DEG", (-25.0, 0.0, 25.0))
        patch.setattr(passes, "TRANSVERSE_TILTS_DEG", (0.0, 30.0))
        patch.setattr(passes, "WEARABLE_STEP_DEG", 17.5)
        yield
