"""2,000 tables of a dozen makers' layouts, conventions, units, tools, statuses and clocks: read right or asked, never wrong in silence."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from made_tables import LAYOUTS, Made, made_table

from AIFReconLib.errors import AIFReconError
from AIFReconLib.geometry.transform_graph import TransformName, TransformStatus
from AIFReconLib.io.foreign.images import ImportedImages
from AIFReconLib.io.foreign.importing import import_sequence
from AIFReconLib.io.foreign.options import ImportOptions
from AIFReconLib.io.foreign.poses.files import read_poses
from AIFReconLib.message import message_of

EVERY = 10
"""One in so many is tried; 1 tries all 2,000."""

PROBE = TransformName("Probe", "Tracker")


def imported(made: Made, path) -> tuple[np.ndarray, np.ndarray | None]:
    """Poses and times as a user gets them who answers each question with the truth."""
    path.write_text(made.text, encoding="utf-8")
    form, asked = ImportOptions(), []
    for _question in range(8):
        try:
            poses = read_poses(path, form)
            images = ImportedImages(np.zeros((len(poses.matrices), 4, 4), np.uint8), "images")
            sequence, _understood = import_sequence(images, poses, replace(form, transform=str(PROBE)))
        except AIFReconError as error:
            asked.append((*message_of(error).settings, str(error))[0])
            if asked[-1] not in made.answers or asked.count(asked[-1]) > 1:
                raise AssertionError(f"{made.layout}: {error}") from error
            form = replace(form, **made.answers[asked[-1]])
            continue
        samples = [record.transforms[PROBE] for record in sequence.records]
        found = np.array([s.matrix if s.status is TransformStatus.OK else np.full((4, 4), np.nan) for s in samples])
        times = [record.timestamp for record in sequence.records]
        return found, None if None in times else np.array(times)
    raise AssertionError(f"{made.layout}: {asked}")


@pytest.mark.parametrize("first", range(len(LAYOUTS)))
def test_a_table_is_read_right_or_asked_about(tmp_path, first):
    for seed in range(first, 2000, EVERY * len(LAYOUTS)):
        made = made_table(seed)
        found, times = imported(made, tmp_path / made.name)
        said = f"table {seed}, {made.layout}"
        np.testing.assert_allclose(found, made.poses, atol=0.01, err_msg=said)
        turned = np.einsum("nij,nik->njk", found[:, :3, :3], made.poses[:, :3, :3])
        assert np.degrees(np.nanmax(np.abs(turned - np.eye(3)))) <= 0.01, said
        assert (times is None) == (made.times is None), said
        if times is not None:
            np.testing.assert_allclose(times - times[0], made.times, atol=1e-4, err_msg=said)
