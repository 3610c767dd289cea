"""A scan that looks where nothing was seen yet: places between the skin and the canal, in place of points on bone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..arrays import Floats
from ..errors import GeometryError, SettingsError
from ..evaluation.surface import BoneSurface
from .bone import GuidedBone

NOT_SEEN = "not seen"
"""What these places are called, as the target of a plan and in its table."""

APART = 3.0
"""mm between such places: each stands for a square of this side."""


def window(bone: GuidedBone, unseen: Floats) -> GuidedBone:
    """Places that were not seen, as `plan_scan` and `NextMove` take bone: in the shadow of all bone there is, and facing the back.

    A beam that reaches such a place tells it; one within 35 degrees of straight ahead tells more than one from the side.
    Raises GeometryError where there is no such place.

    Parameters
    ----------
    bone : GuidedBone
        All that throws a shadow.
    unseen : (n, 3) array, mm in Reference
        As `FreePaths.unseen` has them.
    """
    if not len(unseen):
        raise GeometryError("No window was left untold: these paths were seen, or are blocked by bone that was.")
    facing = np.broadcast_to(-bone.patient_to_reference[:3, 1], (len(unseen), 3))
    surface = BoneSurface(np.asarray(unseen, dtype=np.float64), facing, np.full(len(unseen), APART**2), np.zeros(len(unseen), np.int64))
    return replace(bone, surface=surface, border=np.ones(len(unseen), dtype=bool), names={**bone.names, 0: NOT_SEEN})


def unseen_of(document: object) -> Floats:
    """The places of paths that were read from JSON, (n, 3).

    Raises SettingsError when it is not what `aifrecon paths` writes.
    """
    windows = document.get("windows") if isinstance(document, dict) else None
    try:
        places = [place for one in windows if not one["free"] for place in one["unseen"]]  # type: ignore[union-attr]
        found = np.asarray(places, dtype=np.float64).reshape(-1, 3)
    except (TypeError, KeyError, ValueError):
        found = np.full((1, 3), np.nan)
    if not np.isfinite(found).all():
        raise SettingsError("Input unseen must be the JSON that aifrecon paths writes, with the windows that were not seen.")
    return found
