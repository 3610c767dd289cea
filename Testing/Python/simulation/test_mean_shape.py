"""The phantom's vertebrae behind, as a probe sees them, against the mean shape of 87 patients."""

import numpy as np
import pytest
from mean_shape import distances_behind

from AIFReconLib.simulation.morphometry import TYPICAL
from AIFReconLib.simulation.vertebra import Vertebra


@pytest.mark.parametrize("level", ["L2", "L3", "L4", "L5"])
def test_a_typical_vertebra_looks_from_behind_as_that_of_patients(real_data, level):
    """Reached: medians of 0.5, 0.5, 0.5 and 0.6 mm, 95th percentiles of 1.1, 1.4, 1.1 and 1.6; boxes had 1.8 and 5.5 to 8.9."""
    folder = real_data(f"lumbar-shape/{level}.stl").parent
    distances = distances_behind(Vertebra(1, level, np.eye(4), TYPICAL[level]), folder)
    assert np.median(distances) < 0.7
    assert np.percentile(distances, 95) < 2.0


def test_a_vertebra_of_another_level_is_farther_away(real_data):
    folder = real_data("lumbar-shape/L3.stl").parent
    other = Vertebra(1, "L3", np.eye(4), TYPICAL["L5"])
    assert np.percentile(distances_behind(other, folder), 95) > 4.0
