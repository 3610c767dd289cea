"""A network's model in an ONNX file: run by onnxruntime itself, or refused in one sentence."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("onnxruntime")
pytest.importorskip("onnx")

from files import refused, write_patient_with_bone
from onnx import helper
from onnx_models import graph_of, saved, scaling
from seen_planes import PlaneSweep

from AIFReconLib.bone.network.model import OnnxModel
from AIFReconLib.commands.parser import main
from AIFReconLib.errors import FileFormatError
from AIFReconLib.sweep.frames import TrackedFrame

GRAY = np.random.default_rng(0).integers(0, 256, (48, 40), dtype=np.uint8)


def model_in(folder, model, **description) -> Path:
    path = saved(model, folder / "model.onnx")
    if description:
        path.with_suffix(".json").write_text(json.dumps(description))
    return path


def answer(path, image=GRAY):
    return OnnxModel(path).estimate(TrackedFrame(image, np.eye(4))).probability


# What goes in and comes out


def test_gray_levels_go_in_as_fractions_of_white_less_mean_over_std(tmp_path):
    path = model_in(tmp_path, scaling(), mean=0.25, std=2.0, output="logits")
    expected = 1 / (1 + np.exp(-(GRAY / 255 - 0.25) / 2.0))
    np.testing.assert_allclose(answer(path), expected, atol=1e-6)


def test_of_several_classes_bone_is_the_one_that_is_named(tmp_path):
    model = scaling(channels=3)
    path = model_in(tmp_path, model, output="classes", bone_class=2)
    np.testing.assert_allclose(answer(path), 1 / 3, atol=1e-6)


@pytest.mark.parametrize("description", [{"input_size": [24, 20]}, {}])
def test_images_are_resized_to_what_the_model_takes(tmp_path, description):
    shape = (1, 1, None, None) if description else (1, 1, 24, 20)
    path = model_in(tmp_path, scaling(shape=shape), output="probability", **description)
    flat = np.repeat(np.arange(48, dtype=np.uint8)[:, None] * 4, 40, axis=1)
    found = answer(path, flat)
    assert found.shape == (24, 20)
    # Each row is the middle of two, but at the border
    np.testing.assert_allclose(255 * found[1:-1, 7], 4 * (2 * np.arange(1, 23) + 0.5), atol=1e-3)


# What is refused


def words(path):
    path.write_text("this is a letter, and no model")


def cut_short(path):
    saved(scaling(), path)
    path.write_bytes(path.read_bytes()[:-20])


def external(path):
    saved(scaling(), path, save_as_external_data=True, location="weights.bin", size_threshold=0)


def without_its_weights(path):
    external(path)
    path.with_name("weights.bin").unlink()


def missing_operator(path):
    saved(graph_of([helper.make_node("Frobnicate", ["image"], ["bone"])], {}, [1, 1, 8, 8], [1, 1, 8, 8]), path)


def of_four_channels(path):
    saved(scaling(shape=(1, 4, None, None)), path)


def of_one_number(path):
    saved(
        graph_of(
            [helper.make_node("GlobalMaxPool", ["image"], ["m"]), helper.make_node("Flatten", ["m"], ["bone"])], {}, [1, 1, 8, 8], [1, 1]
        ),
        path,
    )


def of_nan(path):
    saved(
        graph_of(
            [helper.make_node("Log", ["image"], ["log"]), helper.make_node("Sub", ["log", "log"], ["bone"])], {}, [1, 1, 8, 8], [1, 1, 8, 8]
        ),
        path,
    )


@pytest.mark.parametrize(
    ("make", "sentence"),
    [
        (words, "cannot run this model .*Protobuf"),
        (cut_short, "cannot run this model .*Protobuf"),
        (without_its_weights, "cannot run this model .*[Ee]xternal data"),
        (missing_operator, "cannot run this model .*Frobnicate"),
        (of_four_channels, r"input is 1 x 4 x h x w, .* 1 x 1 x H x W or 1 x 3 x H x W"),
        (of_one_number, "answers with float32 of 1 x 1, "),
        (of_nan, "answers NaN or infinity"),
    ],
)
def test_what_is_no_model_of_bone_is_refused_in_a_sentence(tmp_path, make, sentence):
    path = tmp_path / "model.onnx"
    make(path)
    with pytest.raises(FileFormatError, match=sentence) as refusal:
        OnnxModel(path)
    assert "\n" not in str(refusal.value)


@pytest.mark.parametrize(
    ("description", "sentence"),
    [
        ("{", "this is no JSON"),
        ("[]", "must be an object"),
        ('{"colour": 1}', "colour is not known. Write an object with input_size, mean"),
        ('{"input_size": [0, 5]}', "input_size must be at least 1; got 0"),
        ('{"input_size": [16, 16]}', "fails with an input of 1 x 1 x 16 x 16 .* Check input_size"),
        ('{"std": 0}', "std must be at least 1e-09"),
        ('{"std": [1, 2]}', "std must be one number or three"),
        ('{"std": [1, 2, 3]}', "must be one number, or 1"),
        ('{"mean": 1e400}', "mean must be one number or three"),
        ('{"output": "heat"}', "output must be one of logits, probability, classes"),
        ('{"bone_class": -1}', "bone_class must be at least 0"),
        ('{"output": "classes", "bone_class": 1}', "has no class 1 of several"),
    ],
)
def test_a_description_that_does_not_fit_is_refused(tmp_path, description, sentence):
    path = model_in(tmp_path, scaling(shape=(1, 1, 8, 8)))
    path.with_suffix(".json").write_text(description)
    with pytest.raises(FileFormatError, match=sentence):
        OnnxModel(path)


def test_logits_that_pass_for_probabilities_are_refused_with_the_frame(tmp_path):
    path = model_in(tmp_path, scaling(9.0), output="probability")
    with pytest.raises(FileFormatError, match="in frame 7, which is no probability"):
        OnnxModel(path).estimate(TrackedFrame(GRAY, np.eye(4), number=7))


def test_the_network_that_is_trained_on_simulated_frames_knows_an_echo_over_darkness():
    path = Path(__file__).resolve().parents[2] / "models" / "bone.onnx"
    assert path.stat().st_size < 1.5e6
    sweep = PlaneSweep(count=1)
    said = OnnxModel(path).estimate(TrackedFrame(sweep.images[0], sweep.poses[0])).probability
    depth = sweep.depths(256, 256)[0]
    assert said[np.abs(depth) < 1].mean() > 0.5
    assert said[np.abs(depth) > 4].mean() < 0.01


def test_the_command_takes_a_model_and_refuses_what_is_none(tmp_path, capsys):
    (tmp_path / "results").mkdir()
    patient = write_patient_with_bone(tmp_path / "inputs")
    path = model_in(tmp_path / "inputs", scaling(20.0, -5.0))
    command = [*patient.reconstruct, "--engine", "numpy", "--bone-model", str(path), "--output", str(tmp_path / "results" / "v.nrrd")]
    assert main(command) == 0
    assert "Bone is what the model model.onnx says." in capsys.readouterr().out
    (tmp_path / "results" / "v.nrrd").unlink()
    words(path)
    assert "cannot run this model" in refused(command, capsys, tmp_path / "results")


def test_weights_in_a_file_beside_the_model_are_read(tmp_path):
    """As PyTorch exports them by default."""
    (tmp_path / "one").mkdir()
    external(tmp_path / "model.onnx")
    np.testing.assert_array_equal(answer(tmp_path / "model.onnx"), answer(model_in(tmp_path / "one", scaling())))
