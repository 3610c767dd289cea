"""docs/method.md and settings.py say the same of every parameter."""

import re
from dataclasses import fields
from pathlib import Path

import pytest

from AIFReconLib.recipe.recipe import DEFAULT_SPACING, ReconstructionSettings

PAGE = (Path(__file__).parents[3] / "docs" / "method.md").read_text(encoding="utf-8")
ROWS = re.findall(r"^\| `(--[a-z-]+)` \| `([a-z_]+)` \| (.+?) \| (.+?) \|$", PAGE, re.MULTILINE)
RULES = {spec.name: spec.metadata for spec in fields(ReconstructionSettings)}
NUMBER = r"[0-9.]+(?:e-?[0-9]+)?"


def test_the_page_has_the_table():
    assert {"alpha", "beta", "bone_gain", "weight_floor", "hole_limit", "spacing"} <= {field for _, field, _, _ in ROWS}


@pytest.mark.parametrize(("option", "field", "default", "bounds"), [row for row in ROWS if row[1] != "method"])
def test_a_row_states_the_option_default_and_range_of_its_field(option, field, default, bounds):
    rule = RULES[field]
    assert option == "--" + field.replace("_", "-")
    expected = DEFAULT_SPACING if field == "spacing" else rule["default"]
    if expected is None:
        assert default == "none"
    elif isinstance(expected, str):
        assert default == f"`{expected}`"
    else:
        assert float(re.match(NUMBER, default)[0]) == expected
    if rule["choices"] is not None:
        assert tuple(re.findall(r"`([^`]+)`", bounds)) == rule["choices"]
    else:
        assert [float(n) for n in re.findall(NUMBER, bounds)] == [n for n in (rule["minimum"], rule["maximum"]) if n is not None]
