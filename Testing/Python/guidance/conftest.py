"""Fewer candidate passes than a probe has, so that tests are quick, and watches that tell at once."""

from __future__ import annotations

import numpy as np
import pytest
from idle_session import IMAGES, IdleSession
from sweeps import two_vertebrae
from waiting import until

from AIFReconLib.guidance import passes
from AIFReconLib.guidance.bone import guided_bone
from AIFReconLib.guidance.probe import ProbeOnBack, Skin
from AIFReconLib.live.session import guidance_watch


@pytest.fixture(scope="package", autouse=True)
def few_candidates():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(passes, "SAGITTAL_TILTS_DEG", (-38.0, 0.0, 38.0))
        patch.setattr(passes, "SAGITTAL_ACROSS_DEG", (-25.0, 0.0, 25.0))
        patch.setattr(passes, "TRANSVERSE_TILTS_DEG", (0.0, 30.0))
        patch.setattr(passes, "WEARABLE_STEP_DEG", 17.5)
        yield


@pytest.fixture(scope="package")
def bone():
    """Two vertebrae where their labels lie."""
    return guided_bone(two_vertebrae())


@pytest.fixture(scope="module")
def probe(bone):
    """The simulated probe on the back over that bone."""
    return ProbeOnBack(IMAGES, Skin.over(bone), bone.patient_to_reference)


@pytest.fixture
def watching(monkeypatch):
    """Makes watches that tell everything at once, of a CT of two vertebrae where no other bone is given."""
    for name in ("TELL_EVERY", "ADVISE_EVERY", "SKIN_AFTER", "RENEW_EVERY"):
        monkeypatch.setattr(guidance_watch, name, 0)
    watches = []

    def watch(*bone, **more):
        session = IdleSession()
        watches.append(guidance_watch.GuidanceWatch(session, *(bone or (two_vertebrae(), np.eye(4))), **more))
        assert until(watches[-1].prepared.is_set)
        return session, watches[-1]

    yield watch
    for one in watches:
        one.stop()
