"""`aifrecon reconstruct --report FILE.html`: the page that the panel saves."""

from __future__ import annotations

from AIFReconLib.commands.parser import main


def page_of(command, results) -> str:
    path = results / "page.html"
    assert main([*command, "--output", str(results / "v.nrrd"), "--report", str(path)]) == 0
    return path.read_text("utf-8")


def test_a_page_tells_of_sweep_and_ct_with_pictures_of_both_kinds(patient, results, capsys):
    page = page_of([*patient.reconstruct, *patient.bone, "--method", "weighted"], results)
    assert f"wrote {results / 'page.html'}" in capsys.readouterr().out
    for words in ("v.nrrd", "not for guiding a needle", "CT and sweep", "Bone hit by the beams", "; as measured", "Violet"):
        assert words in page
    assert page.count("data:image/png") == 6


def test_without_a_ct_it_says_so_and_shows_what_was_measured_once(patient, results):
    page = page_of([*patient.reconstruct, str(patient.sweep)], results)
    assert "No CT was given." in page
    assert "Orange" not in page
    assert page.count("data:image/png") == 3
    # Each of several sweeps has its own rows
    assert page.count("Frames used") == 2
