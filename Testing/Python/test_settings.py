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


@pytest.mark.parametrize("name", FIELDS)
def test_every_default_is_allowed(name):
    assert ReconstructionSettings(**{name: FIELDS[name].default}) == ReconstructionSettings()


@pytest.mark.parametrize(("name", "rule"), BOUNDED)
def test_both_ends_of_a_range_belong_to_it(name, rule):
    for bound in (rule["minimum"], rule["maximum"]):
        if bound is not None:
            assert getattr(ReconstructionSettings(**{name: bound}), name) == bound


@pytest.mark.parametrize(("name", "rule"), [(name, rule) for name, rule in BOUNDED if rule["maximum"] is not None])
def test_above_a_range_is_refused_by_name(name, rule):
    with pytest.raises(SettingsError, match=f"Input {name} must be at most"):
        ReconstructionSettings(**{name: rule["maximum"] * 1.01 + 1e-9})


@pytest.mark.parametrize("name", NUMBERS)
@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, "1", (1.0, 2.0), True, 1j])
def test_what_is_no_number_is_refused(name, value):
    with pytest.raises(SettingsError, match=f"Input {name} must be"):
        ReconstructionSettings(**{name: value})


@pytest.mark.parametrize("name", LISTS)
@pytest.mark.parametrize("value", [math.nan, "1", True, (math.nan,) * 4, ("1", "2"), (1.0,) * 5, ((1.0, 0.0),) * 4])
def test_what_are_not_as_many_numbers_is_refused(name, value):
    with pytest.raises(SettingsError, match=f"Input {name} must be"):
        ReconstructionSettings(**{name: value})


@pytest.mark.parametrize("name", [name for name, spec in FIELDS.items() if spec.metadata["kind"] == TEXT])
def test_what_is_no_text_is_refused(name):
    with pytest.raises(SettingsError, match=f"Input {name} must be a text; got 1"):
        ReconstructionSettings(**{name: 1})


@pytest.mark.parametrize("name", [name for name, spec in FIELDS.items() if spec.default is not None])
def test_none_is_refused_where_it_has_no_meaning(name):
    with pytest.raises(SettingsError, match=f"Input {name} must be"):
        ReconstructionSettings(**{name: None})


@pytest.mark.parametrize("value", [(1, 2, 3), [1.0, 2.0, 3.0], np.array([1.0, 2.0, 3.0]), np.array([1, 2, 3], np.int32)])
def test_a_spacing_of_three_becomes_a_tuple_of_floats(value):
    assert ReconstructionSettings(spacing=value).spacing_xyz() == (1.0, 2.0, 3.0)


@pytest.mark.parametrize("bad", [math.nan, 0.0, -1.0, 51.0, None, "1", True])
def test_one_bad_spacing_of_three_is_refused(bad):
    with pytest.raises(SettingsError, match="Input spacing must be"):
        ReconstructionSettings(spacing=(1.0, bad, 1.0))


@pytest.mark.parametrize(("has_bone", "method"), [(True, "weighted"), (False, "average")])
def test_the_default_method_depends_on_bone(has_bone, method):
    assert ReconstructionSettings().method_for(has_bone) == method


def test_a_changed_copy_is_checked_too():
    with pytest.raises(SettingsError):
        replace(ReconstructionSettings(), beta=0.0)
