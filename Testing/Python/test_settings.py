"""Parameters: their ranges, choices and descriptions."""

from __future__ import annotations

import math
from dataclasses import fields, replace

import numpy as np
import pytest

from AIFReconLib.errors import SettingsError
from AIFReconLib.recipe.recipe import ReconstructionSettings
from AIFReconLib.recipe.rules import MATRIX, NUMBER, TEXT, WHOLE
from AIFReconLib.recipe.rules import NUMBERS as LIST_OF_NUMBERS

FIELDS = {spec.name: spec for spec in fields(ReconstructionSettings)}
BOUNDED = [(name, spec.metadata) for name, spec in FIELDS.items() if spec.metadata["minimum"] is not None]
NUMBERS = [name for name, spec in FIELDS.items() if spec.metadata["kind"] in (NUMBER, WHOLE)]
LISTS = [name for name, spec in FIELDS.items() if spec.metadata["kind"] in (LIST_OF_NUMBERS, MATRIX)]


@pytest.mark.parametrize(("name", "rule"), BOUNDED)
def test_both_ends_of_a_range_belong_to_it(name, rule):
    for bound in (rule["minimum"], rule["maximum"]):
        if bound is not None:
            assert getattr(ReconstructionSettings(**{name: bound}), name) == bound


@pytest.mark.parametrize(("name", "rule"), [(name, rule) for name, rule in BOUNDED if rule["maximum"] is not None])
def test_above_a_range_is_refused_by_name(name, rule):
    with pytest.raises(SettingsError, match=f"Input {name} must be at most"):
        ReconstructionSettings(**{name: rule["maximum"] * 1.01 + 1e-9})


NO_NUMBER = (math.nan, math.inf, -math.inf, "1", (1.0, 2.0), True, 1j)
NO_LIST = (math.nan, "1", True, (math.nan,) * 4, ("1", "2"), (1.0,) * 5, ((1.0, 0.0),) * 4)
WRONG = [
    *((name, value) for name in NUMBERS for value in NO_NUMBER),
    *((name, value) for name in LISTS for value in NO_LIST),
    *((name, 1) for name, spec in FIELDS.items() if spec.metadata["kind"] == TEXT),
    *((name, None) for name, spec in FIELDS.items() if spec.default is not None),
    *(("spacing", (1.0, bad, 1.0)) for bad in (math.nan, 0.0, -1.0, 51.0, None, "1", True)),
]


@pytest.mark.parametrize(("name", "value"), WRONG)
def test_what_is_of_another_kind_is_refused_by_name(name, value):
    with pytest.raises(SettingsError, match=f"Input {name} must be"):
        replace(ReconstructionSettings(), **{name: value})


@pytest.mark.parametrize("value", [(1, 2, 3), [1.0, 2.0, 3.0], np.array([1.0, 2.0, 3.0]), np.array([1, 2, 3], np.int32)])
def test_a_spacing_of_three_becomes_a_tuple_of_floats(value):
    assert ReconstructionSettings(spacing=value).spacing_xyz() == (1.0, 2.0, 3.0)
