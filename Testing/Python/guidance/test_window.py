"""Places that no beam has reached: plans and moves lead there, past all bone, wherever the patient lies."""

from __future__ import annotations

import json

import numpy as np
import pytest
from idle_session import RECIPE, sweep_at
from sweeps import rigid, two_vertebrae

from AIFReconLib.commands.parser import main
from AIFReconLib.errors import GeometryError, SettingsError
from AIFReconLib.geometry.transforms import invert, transform_points
from AIFReconLib.guidance.bone import guided_bone
from AIFReconLib.guidance.candidates import geometry_of
from AIFReconLib.guidance.guidance import guidance_of_sweep
from AIFReconLib.guidance.plan import plan_scan
from AIFReconLib.guidance.probe import ProbePlacement
from AIFReconLib.guidance.window import APART, NOT_SEEN, unseen_of, window

PLACE = rigid((5.0, -8.0, 12.0), (20.0, 10.0, -5.0))


def between(bone) -> np.ndarray:
    """Places on straight lines through the gap between both vertebrae, beside the midline, in Reference."""
    z, y, x = (axis.ravel() for axis in np.meshgrid((-3.0, 0.0, 3.0), np.arange(-20.0, 10.0, APART), (9.0, 12.0), indexing="ij"))
    return transform_points(bone.patient_to_reference, np.stack([x, y, z], axis=1))


@pytest.fixture(scope="module", params=[np.eye(4), PLACE], ids=["upright", "oblique"])
def bone(request):
    return guided_bone(two_vertebrae(), request.param)


def test_a_plan_reaches_more_of_the_places_than_one_for_bone_does(bone, probe):
    aimed = window(bone, between(bone))
    geometry, shares = geometry_of(aimed, probe), []
    for looks_at, target in ((aimed, NOT_SEEN), (bone, "interspinous")):
        plan = plan_scan(looks_at, probe, target, 24, hand=None)
        _, points, _ = geometry.support(np.concatenate([one.image_to_reference for one in plan.passes]))
        shares.append(len(np.unique(points)) / len(aimed))
    assert shares[0] > 0.8
    assert shares[0] > shares[1] + 0.1


def test_bone_throws_its_shadow_on_such_places(bone, probe):
    inside = bone.surface.points_reference + 12.0 * bone.patient_to_reference[:3, 1]
    aimed = window(bone, inside[bone.posterior][::7])
    straight = np.stack([probe.pose(ProbePlacement(x, 0.0, 90.0)) for x in np.arange(-20.0, 21.0, 2.0)])
    _, points, _ = geometry_of(aimed, probe).support(straight)
    assert len(np.unique(points)) < 0.3 * len(aimed)


def test_the_next_move_of_a_sweep_leads_there(bone, probe):
    sweep = sweep_at([probe.pose(ProbePlacement(x, 60.0, 90.0)) for x in (-6.0, 0.0, 6.0)])
    to_reference = bone.patient_to_reference @ invert(guided_bone(two_vertebrae()).patient_to_reference)
    places = between(bone)
    found = guidance_of_sweep(sweep, two_vertebrae(), to_reference, RECIPE, unseen=places)
    plain = guidance_of_sweep(sweep, two_vertebrae(), to_reference, RECIPE)
    np.testing.assert_array_equal(found.levels, plain.levels)  # colors are of bone in any case
    assert (found.seen().move.adds_cm2, plain.seen().move.adds_cm2 > 0) == (None, True)
    move = found.advice.move
    _, points, _ = geometry_of(window(bone, places), probe).support(move.planned.poses(probe))
    assert len(np.unique(points)) > 0.3 * len(places)


def test_places_of_a_report_and_what_is_none():
    report = {"windows": [{"free": True, "unseen": [[9, 9, 9]]}, {"free": False, "unseen": [[1, 2, 3], [4, 5, 6]]}]}
    np.testing.assert_array_equal(unseen_of(report), [[1, 2, 3], [4, 5, 6]])
    assert unseen_of({"windows": []}).shape == (0, 3)
    for wrong in ([], {}, {"windows": [{"free": False}]}, {"windows": [{"free": False, "unseen": [[1, None, 3]]}]}, {"windows": 3}):
        with pytest.raises(SettingsError, match="aifrecon paths"):
            unseen_of(wrong)


def test_nothing_left_to_see_is_said():
    with pytest.raises(GeometryError, match="No window was left untold"):
        window(guided_bone(two_vertebrae()), np.empty((0, 3)))


def test_the_command_aims_at_a_report_of_paths(tmp_path, capsys):
    labels, report, output = (tmp_path / name for name in ("labels.nrrd", "paths.json", "plan.json"))
    two_vertebrae().write(labels)
    bone = guided_bone(two_vertebrae())
    report.write_text(json.dumps({"windows": [{"free": False, "unseen": between(bone).tolist()}]}))
    command = ["plan", "--bone-labels", str(labels), "--unseen", str(report), "--frames", "24", "--output", str(output)]
    assert main(command) == 0
    assert f"% of {NOT_SEEN}" in capsys.readouterr().out
    assert json.loads(output.read_text())["target"] == NOT_SEEN
    assert main([*command, "--target", "all"]) == 2
    assert "argument --target: not allowed with argument --unseen" in capsys.readouterr().err
    output.unlink()
    report.write_text("{}")
    assert main(command) == 2
    assert f"{report}: it is no report of paths" in capsys.readouterr().err
    assert not output.exists()
