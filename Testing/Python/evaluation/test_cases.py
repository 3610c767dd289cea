"""Numbers of many cases: means and spreads as they are computed by hand, differences case by case, and what to paste into a paper."""

from __future__ import annotations

import csv
import io
import json
import re

import numpy as np
import pytest
import scipy

from AIFReconLib.errors import FileFormatError, SettingsError
from AIFReconLib.evaluation.cases import CaseNumbers
from AIFReconLib.evaluation.paragraph import CITATION, methods_paragraph, unlike_settings
from AIFReconLib.evaluation.quantities import OWN_BONE, QUANTITIES
from AIFReconLib.geometry.volume import Volume
from AIFReconLib.provenance.record import METHOD, SETTINGS

CNR = {"average": [1.0, 2.0, 4.0, 3.0, 2.5], "weighted": [3.0, 3.5, 7.0, 4.0, 4.5]}


@pytest.fixture
def table(tmp_path):
    """As batch writes it, the rows of one case beside each other."""
    rows = ["case,method,bone_cnr,bone_coverage,bone_area,yardstick,volume,registration_agreement,registered"]
    for case in range(5):
        for method, values in CNR.items():
            own = OWN_BONE if method == "weighted" else "other bone"
            rows.append(f"P{case},{method},{values[case]},0.{case + 1},1000,{own},P{case}/{method}.nrrd,0.{94 + case},yes")
    (tmp_path / "results.csv").write_text("\n".join(rows) + "\n", "utf-8")
    return tmp_path / "results.csv"


@pytest.fixture
def found(table):
    return CaseNumbers.read({"results.csv": table})


def test_mean_and_standard_deviation_are_those_of_the_cases(found):
    cases, mean, deviation, *_ = found.summary("bone_cnr", "weighted", "average")
    assert (cases, mean) == (5, np.mean(CNR["weighted"]))
    assert deviation == pytest.approx(np.std(CNR["weighted"], ddof=1))


def test_differences_are_taken_case_by_case_with_the_interval_of_the_bootstrap(found):
    *_, pairs, mean, low, high = found.summary("bone_cnr", "weighted", "average")
    differences = np.subtract(CNR["weighted"], CNR["average"])
    assert (pairs, mean) == (5, differences.mean())
    theirs = scipy.stats.bootstrap((differences,), np.mean, method="percentile", n_resamples=20_000, rng=np.random.default_rng(1))
    assert (low, high) == pytest.approx(tuple(theirs.confidence_interval), abs=0.05)


def test_a_case_that_one_volume_lacks_is_no_pair(table):
    lines = table.read_text("utf-8").splitlines()
    table.write_text("\n".join(lines[:-1]) + "\n", "utf-8")
    cases, *_, pairs, _, low, high = CaseNumbers.read({"results.csv": table}).summary("bone_cnr", "average", "weighted")
    assert (cases, pairs) == (5, 4)
    assert np.isnan([low, high]).all()  # smallest and largest difference are no interval


def test_with_fewer_than_five_cases_a_difference_has_no_interval(table):
    lines = table.read_text("utf-8").splitlines()
    table.write_text("\n".join(lines[:-2]) + "\n", "utf-8")
    found = CaseNumbers.read({"results.csv": table})
    assert found.tables("average")[1][1] == ["CNR", "+1.88"]
    row = next(
        each
        for each in csv.DictReader(io.StringIO(found.csv("average")))
        if each["quantity"] == "bone_cnr" and each["volume"] == "weighted"
    )
    assert (row["mean_difference"], row["confidence_low"], row["confidence_high"]) == ("1.875", "", "")


def test_what_is_known_of_the_place_of_the_ct_is_told(found):
    lay = "of the bone echoes lay on its bone (mean of 5 cases; least 94%)."
    assert found.registration_in_words() == f"In 5 cases the CT was registered to its sweep [1]; 96% {lay}"
    found.registered.clear()
    assert found.registration_in_words() == f"The CTs lie as given; 96% {lay}"


def test_rows_of_the_terminal_are_quantities(found):
    means, differences = found.tables("average")
    assert means[0] == ["", "average", "weighted"]
    assert means[1][0] == "CNR"
    assert means[1][1].startswith("2.50 ± 1.12")
    assert differences[0] == ["", "weighted"]
    assert differences[1][1].startswith("+1.90 [")


def test_the_csv_has_one_unit_for_a_quantity(found):
    rows = list(csv.DictReader(io.StringIO(found.csv("average"))))
    assert len(rows) == 2 * len(QUANTITIES)
    units = {row["quantity"]: row["unit"] for row in rows}
    assert (units["bone_area"], units["bone_coverage"], units["bone_thickness"]) == ("mm2", "share", "mm")
    area = next(row for row in rows if row["quantity"] == "bone_area")
    assert (area["mean"], area["standard_deviation"], area["cases"]) == ("1000", "0", "5")


def test_the_others_are_compared_with_the_average_unless_told_otherwise(found):
    assert found.reference(None) == "average"
    assert found.reference("weighted") == "weighted"
    with pytest.raises(SettingsError, match="one of average, weighted; got maximum"):
        found.reference("maximum")


@pytest.mark.parametrize("asked", ["average", "average.nrrd"])
def test_a_volume_that_is_named_by_its_file_is_known_by_its_method_too(asked):
    found = CaseNumbers({"weighted.nrrd": {}, "average.nrrd": {}})
    assert found.reference(asked) == found.reference(None) == "average.nrrd"


def test_a_table_of_a_spreadsheet_with_decimal_commas_has_the_same_numbers(table, found):
    text = table.read_text("utf-8").replace(",", ";").replace(".5", ",5").replace("0.", "0,")
    table.write_text(text, "utf-8-sig")
    assert CaseNumbers.read({"results.csv": table}).numbers == found.numbers


def test_cases_that_are_one_or_have_no_numbers_are_told(table):
    more = ["P0,average,8.0,0.1,1000,other bone,x.nrrd", "P8,average,,,,,"]
    table.write_text(table.read_text("utf-8") + "\n".join(more), "utf-8")
    twice, none = CaseNumbers.read({"results.csv": table}).notes
    assert twice.startswith("WARNING: average of P0 stands there twice")
    assert none == "Left out, as it has no numbers: average of P8."


def test_settings_that_differ_between_cases_are_told_and_what_is_found_for_each_is_not(tmp_path):
    volumes = {}
    for case, spacing, limit in (("P1", 1.0, 2.2), ("P2", 2.0, 2.5), ("P3", 1.0, 2.2)):
        settings = {"spacing": spacing, "hole_limit": limit, "bone_sigma_mm": "auto" if case == "P3" else spacing}
        fields = {METHOD: "weighted", SETTINGS: json.dumps(settings)}
        volumes[case] = tmp_path / f"{case}.nrrd"
        Volume(np.ones((2, 2, 2), np.uint8), np.eye(4), fields).write(volumes[case])
    spacing, bone = unlike_settings({"weighted": volumes})
    assert spacing == "weighted: spacing 1 mm in P1, P3, spacing 2 mm in P2"
    assert bone == "weighted: bone_sigma_mm in P1, P2, the bone of the sweep's own echoes in P3"


@pytest.mark.parametrize("text", ["a,b\n1,2\n", "volume,bone_cnr\nx.nrrd,much\n", "\0\0"])
def test_what_is_no_such_table_is_refused(tmp_path, text):
    (tmp_path / "other.csv").write_text(text, "utf-8")
    with pytest.raises(FileFormatError, match="it is no table of numbers"):
        CaseNumbers.read({"other.csv": tmp_path / "other.csv"})


def test_the_paragraph_has_all_settings_and_what_to_cite():
    settings = {"method": "aif", "alpha": 0.1, "spacing": 0.5, "bone_sigma_mm": 4.0, "grid_size": [10, 20, 30], "grid_to_reference": [[1]]}
    text = methods_paragraph({"a.nrrd": settings, "b.nrrd": {}}, "They were measured against bone.nrrd.", ["a.nrrd"], cases=12)
    assert re.search(r"a.nrrd by the method aif \(.*\) \[2\], with alpha", text)
    assert re.search(r"with alpha 0.1 \(multiplies a pixel by 1 . this x the .*\), spacing 0.5 mm", text)
    assert ", bone sigma 4 mm." in text  # a box differs with the patient
    assert "How b.nrrd was made is not known. They were measured against bone.nrrd." in text
    assert "The bone that a.nrrd was measured against had weighted its frames." in text
    assert "over 12 cases; differences are paired, with 95% confidence intervals by the percentile bootstrap" in text
    assert "BSD-3-Clause.\n" in text
    assert f"[2] {CITATION}" in text


def test_the_paragraph_says_what_was_found_by_what_bone_is_brightened_and_that_data_are_simulated():
    made = {"method": "weighted", "bone_gain": 4.0, "bone_sigma_mm": 1.0, "gray_levels": [1.0, 2.0], "engine": "auto"}
    text = methods_paragraph({"w": {**made, "found": ["bone_sigma_mm"], "simulated": True}}, "", [], cases=3)
    assert "of AIFRecon [1], with bone gain 4 (multiplies a pixel of sure bone by 1 + this x C, C from 1 to 3" in text
    assert "bone sigma 1 mm (found)" in text
    assert "The recordings are simulated." in text
    assert "engine" not in text
    assert "simulated" not in methods_paragraph({"w": made}, "", [])


def test_the_paragraph_defines_every_quantity_of_the_table_by_the_name_that_it_has_there():
    text = methods_paragraph({}, "", [], cases=3)
    assert "of fewer than 5 cases without confidence intervals" in text
    for quantity in QUANTITIES.values():
        assert f"{quantity.label} (" in text
    assert "Shadow spread (shadow_std): " in text
