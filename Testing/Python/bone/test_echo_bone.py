"""Bone drawn from the sweep itself: made-up frames with a bright arc over darkness, for both kinds of probes."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from files import tracked_sequence, write_patient, write_patient_with_bone
from study.scanner_looks import LOOKS
from sweeps import image_pose

from AIFReconLib.bone.echoes.finder import SKIN, BoneEchoFinder
from AIFReconLib.bone.echoes.surface import bone_from_sweep
from AIFReconLib.bone.map import BoneMap
from AIFReconLib.commands.parser import main
from AIFReconLib.effective_settings import Imaging, imaging_fields
from AIFReconLib.geometry.transform_graph import TransformStatus
from AIFReconLib.geometry.transforms import pixel_spacing, transform_points
from AIFReconLib.imaging.beams import LINEAR, SECTOR, ProbeGeometry
from AIFReconLib.imaging.detection import detect_imaging
from AIFReconLib.imaging.gray_levels import STANDARD
from AIFReconLib.imaging.region import Fan, ImageRegion
from AIFReconLib.io.sequence.files import read_sequence
from AIFReconLib.io.volume.files import read_volume
from AIFReconLib.recipe.recipe import Recipe
from AIFReconLib.reconstruction import reconstruct
from AIFReconLib.sweep.frames import TrackedSequence
from AIFReconLib.sweep.poses import sweep_poses
from AIFReconLib.worker.reconstructing import reconstructed as worker_reconstructs
from AIFReconLib.workflows.job import ReconstructionJob

COLUMNS, ROWS, SPACING = 120, 160, (0.25, 0.25)
APEX = (59.5, -20.0)
REGIONS = {
    LINEAR: Imaging(ImageRegion(), ProbeGeometry(LINEAR)),
    SECTOR: Imaging(ImageRegion(fan=Fan(APEX, (-17.0, 17.0), (30.0, 175.0))), ProbeGeometry(SECTOR, APEX)),
}
SKIN_ECHO = 4.0
"""mm below the top at which some images are bright."""


def speckle(seed=0, mean=40.0) -> np.ndarray:
    return np.random.default_rng(seed).rayleigh(mean / math.sqrt(math.pi / 2), (ROWS, COLUMNS))


def arc_row(columns, deepest=18.0, curvature=0.02):
    """Row of a made-up bone surface in each column, higher in the middle as a vertebra's."""
    x = (np.asarray(columns) - (COLUMNS - 1) / 2) * SPACING[0]
    return (deepest + curvature * x**2) / SPACING[1]


def bone_image(seed=0, thickness=0.4, **arc) -> np.ndarray:
    """Speckle down to a bright arc (a Gaussian of `thickness` mm), and next to nothing behind it."""
    image = speckle(seed)
    below = (np.arange(ROWS)[:, None] - arc_row(np.arange(COLUMNS), **arc)[None, :]) * SPACING[1]
    image[below > 0] *= 0.05
    image += 200 * np.exp(-0.5 * (below / thickness) ** 2)
    return np.clip(image, 0, 255).astype(np.uint8)


def finder(kind=LINEAR) -> BoneEchoFinder:
    return BoneEchoFinder((COLUMNS, ROWS), SPACING, REGIONS[kind])


def find(image, kind=LINEAR):
    return finder(kind).find(image)


def oblique_sweep(count=12) -> TrackedSequence:
    """Frames 1 mm apart across their plane, oblique to every axis of Reference."""
    poses = np.repeat(image_pose(SPACING, (25.0, -35.0, 50.0), (12.0, -40.0, 75.0))[None], count, axis=0)
    poses[:, :3, 3] += np.arange(count)[:, None] * poses[0, :3, 2] / np.linalg.norm(poses[0, :3, 2])
    return TrackedSequence.from_arrays(np.stack([bone_image(seed) for seed in range(count)]), poses, 0.1 * np.arange(count))


def bone_of(sequence, kind=LINEAR) -> BoneMap:
    return bone_from_sweep(sequence, Recipe(gray_levels=STANDARD, **imaging_fields(REGIONS[kind].region, REGIONS[kind].probe)))


def at(volume, points):
    """The nearest voxels of points (n, 3) in Reference."""
    i, j, k = np.rint(transform_points(volume.grid.reference_to_ijk, points)).astype(int).T
    return volume.array[k, j, i]


def points_in(pose, columns, rows):
    columns = np.asarray(columns, dtype=float)
    return transform_points(pose, np.stack([columns, rows, 0 * columns], axis=-1))


# One frame


@pytest.mark.parametrize("kind", [LINEAR, SECTOR])
def test_echoes_lie_on_a_bright_arc_over_darkness(kind):
    echoes = find(bone_image(), kind)
    off = (echoes.pixels[:, 1] - arc_row(echoes.pixels[:, 0])) * SPACING[1]
    assert len(off) > 0.8 * finder(kind).lines
    assert np.abs(off).max() < 0.6
    np.testing.assert_allclose(np.linalg.norm(echoes.beams * SPACING, axis=1), 1.0, rtol=1e-6)


def over_darkness(depth) -> np.ndarray:
    """Speckle, a bright line at so many mm, and next to nothing behind it."""
    image, row = speckle(), round(depth / SPACING[1])
    image[row - 2 : row + 3] = 255
    image[row + 3 :] *= 0.05
    return image


def line_in_tissue() -> np.ndarray:
    image = speckle(mean=80.0)
    image[90:94] = 160
    return image


@pytest.mark.parametrize(
    ("image", "is_bone"),
    [
        *((speckle(seed), False) for seed in range(3)),
        (line_in_tissue(), False),
        (over_darkness(SKIN_ECHO), False),
        (over_darkness(SKIN + SKIN_ECHO), True),
    ],
    ids=["speckle 0", "speckle 1", "speckle 2", "tissue behind it", "skin", "below the skin"],
)
@pytest.mark.parametrize("kind", [LINEAR, SECTOR])
def test_bone_is_a_bright_line_below_the_skin_over_darkness(kind, image, is_bone):
    assert (find(image.astype(np.uint8), kind).scores.size > 0.9 * finder(kind).lines) == is_bone
    assert is_bone or not find(image.astype(np.uint8), kind).scores.size


@pytest.mark.parametrize("deepest", np.arange(18.0, 18.25, 0.05))
def test_the_place_of_an_echo_is_good_to_a_twentieth_of_a_millimeter_between_samples(deepest):
    below = (np.arange(ROWS)[:, None] - deepest / SPACING[1] + np.zeros(COLUMNS)) * SPACING[1]
    image = 4.0 * (below < 0) + 200 * np.exp(-0.5 * (below / 0.6) ** 2)
    echoes = find(image)
    np.testing.assert_allclose(echoes.pixels[:, 1] * SPACING[1], deepest, atol=0.05)


@pytest.mark.parametrize("look", ["gain +8 dB of 60", "gray curve 0.6"])
def test_the_same_bone_is_found_whatever_the_knobs_are_set_to(look):
    rng = np.random.default_rng(0)
    images = np.stack([np.clip(bone_image() + rng.integers(0, 30, (ROWS, COLUMNS)), 1, 255).astype(np.uint8) for _ in range(6)])

    def found(seen):
        judging = REGIONS[LINEAR].judging(seen, None)
        return BoneEchoFinder((COLUMNS, ROWS), SPACING, judging).find(seen[0])

    ours, theirs = found(images), found(LOOKS[look](images))
    np.testing.assert_allclose(theirs.pixels, ours.pixels, atol=0.5)
    np.testing.assert_allclose(theirs.scores, ours.scores, atol=0.05)


# The map


@pytest.mark.parametrize("kind", [LINEAR, SECTOR])
def test_the_map_of_an_oblique_sweep_is_high_on_the_surface_alone_and_has_its_inside_behind_it(kind):
    sequence = oblique_sweep()
    bone, pose = bone_of(sequence, kind), sweep_poses(sequence).image_to_reference[6]

    def met(volume, behind):
        columns = np.arange(40, 80)
        return at(volume, points_in(pose, columns, arc_row(columns) + behind / SPACING[1]))

    assert met(bone.probability, 0.0).min() > 0.6
    assert max(met(bone.probability, shift).max() for shift in (-8.0, 8.0)) < 0.01
    assert not met(bone.inside, -2.5).any()
    assert met(bone.inside, 2.5).all()


def test_a_frame_that_cannot_be_placed_takes_no_part():
    sequence = oblique_sweep()
    expected = bone_of(TrackedSequence(np.delete(sequence.images, 3, axis=0), sequence.records[:3] + sequence.records[4:]))
    [(name, sample)] = sequence.records[3].transforms.items()
    sequence.records[3].transforms[name] = replace(sample, status=TransformStatus.OUT_OF_VIEW)
    sequence.images[3] = 255
    np.testing.assert_array_equal(bone_of(sequence).probability.array, expected.probability.array)


# The command line


@pytest.fixture
def patient(tmp_path):
    return write_patient_with_bone(tmp_path / "inputs")


def reconstructed(patient, path, *options) -> np.ndarray:
    assert main([*patient.reconstruct, *options, "--output", str(path)]) == 0
    return read_volume(path).array


def test_that_is_what_happens_where_nobody_has_said_how(patient, tmp_path, capsys):
    asked = reconstructed(patient, tmp_path / "asked.nrrd", "--bone-from-sweep", "--method", "weighted")
    assert "No CT" not in capsys.readouterr().out
    np.testing.assert_array_equal(reconstructed(patient, tmp_path / "v.nrrd"), asked)
    assert "No CT. Bone was found by" in capsys.readouterr().out
    again = reconstructed(patient, tmp_path / "again.nrrd", "--settings", str(tmp_path / "v.nrrd"))
    np.testing.assert_array_equal(again, asked)
    made = worker_reconstructs(ReconstructionJob(read_sequence(patient.sweep, config=patient.config)))
    np.testing.assert_array_equal(made.result.intensity.array, asked)
    assert any("No CT. Bone was found by" in line for line in made.lines)
    in_python = reconstruct(read_sequence(patient.sweep, config=patient.config))
    np.testing.assert_array_equal(in_python.intensity.array, asked)
    assert any("No CT. Bone was found by" in note for note in in_python.notes)


def test_images_without_bone_are_averaged_and_it_is_said(tmp_path, capsys):
    images = np.random.default_rng(0).integers(20, 60, (6, 30, 40), dtype=np.uint8)
    patient = write_patient(tmp_path, tracked_sequence(images=images))
    plain = reconstructed(patient, tmp_path / "plain.nrrd", "--method", "average")
    assert "No CT" not in capsys.readouterr().out
    np.testing.assert_array_equal(reconstructed(patient, tmp_path / "v.nrrd"), plain)
    said = capsys.readouterr().out
    assert "a plain average" in said
    assert "--clip-px" in said


def test_a_configuration_that_names_a_method_is_followed(patient, tmp_path, capsys):
    config = patient.config.read_text("utf-8").replace("<VolumeReconstruction ", '<VolumeReconstruction CompoundingMode="MAXIMUM" ', 1)
    patient.config.write_text(config, "utf-8")
    assert "MAXIMUM" in config
    reconstructed(patient, tmp_path / "v.nrrd")
    said = capsys.readouterr().out
    assert said.startswith("maximum")
    assert "No CT" not in said


# Real recordings


def test_the_surface_of_a_real_bone_is_found_as_one_line(real_data):
    sequence = read_sequence(real_data("BoneUltrasound_L14.igs.mha"), config=real_data("BoneUltrasound_L14_config.xml"))
    spacing = pixel_spacing(sweep_poses(sequence).image_to_reference[10])
    detected = detect_imaging(sequence.images, spacing)
    looking = BoneEchoFinder(sequence.frame_size, spacing, Imaging(detected.region, detected.probe))
    echoes = looking.find(sequence.images[10])
    depth = echoes.pixels[:, 1] * spacing[1]
    assert len(depth) > 0.5 * looking.lines
    assert np.abs(np.diff(depth)).max() < 1.5
