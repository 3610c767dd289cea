"""Some of the made screens of a scanner: the probe is told from them rightly, or refused."""

from __future__ import annotations

import pytest
from scanner_screens import DECOYS, REFUSED, RIGHT, answer, decoy, screen

SEEDS = (0, 2, 4, 5, 7, 8, 10, 12, 58, 62, 99, 104, 148, 191, 1084, 30073, 30140, 30187, 40028, 40115, 70177, 80079, 80131, 80473, 80516)
REFUSALS = {
    **{kind: (decoy, seed) for seed, kind in enumerate(DECOYS)},
    "the middle of a sector that the border cuts off below": (decoy, 30027),
    "a sector whose sides are covered where only a higher level shows its arc": (decoy, 40015),
    "a narrow middle of a sector whose noise hides its arc at lower levels": (decoy, 50027),
    "a clock beside the middle of a sector": (decoy, 30031),
    "a moving picture that two borders and a trace bound": (decoy, 80342),
    "a box most of which stands still": (decoy, 80260),
    "a sector of which a surer level tells another apex": (screen, 110121),
}


@pytest.mark.parametrize("seed", SEEDS)
def test_a_probe_is_told_from_a_screen(seed):
    assert answer(screen(seed)) == RIGHT


@pytest.mark.parametrize(("make", "seed"), REFUSALS.values(), ids=REFUSALS)
def test_what_shows_no_probe_for_sure_is_refused(make, seed):
    assert answer(make(seed)) == REFUSED
