import numpy as np
import pytest

from AIFReconLib.simulation import images as module
from AIFReconLib.simulation.anatomy import LumbarAnatomy, make_lumbar_phantom
from AIFReconLib.simulation.images import FEWEST, Images
from AIFReconLib.simulation.phased_array import PhasedArray
from AIFReconLib.simulation.scan import multi_angle_sweep

PROBE = PhasedArray(columns=40, rows=32, lines=24, samples=48)
FRAMES = 3 * FEWEST + 1


@pytest.fixture(scope="module")
def images():
    phantom = make_lumbar_phantom(LumbarAnatomy.from_seed(2), spacing=2.0)
    poses = [PROBE.probe_to_reference(pose) for pose in multi_angle_sweep(phantom, FRAMES).transducer_to_reference]
    return Images(phantom, PROBE, np.array(poses), seed=5, effects=None)


@pytest.fixture(scope="module")
def alone(images):
    return np.array(list(images.drawn()))


@pytest.mark.parametrize("processes", [2, 3, 64])
def test_several_processes_draw_what_one_draws(images, alone, processes, monkeypatch):
    started, real = [], module._start
    monkeypatch.setattr(module, "_start", lambda *told: started.append(real(*told)) or started[-1])
    assert np.array_equal(list(images.drawn(processes)), alone)
    assert len(started) == min(processes, 3) - 1
    assert all(process.poll() is not None for process, _connection in started)


@pytest.mark.parametrize("after", [0, 4, FRAMES // 2])
def test_a_process_that_is_killed_costs_no_image(images, alone, after, monkeypatch):
    started, real = [], module._start
    monkeypatch.setattr(module, "_start", lambda *told: started.append(real(*told)) or started[-1])
    drawn = []
    for image in images.drawn(2):
        drawn.append(image)
        if len(drawn) == after + 1:
            started[0][0].kill()
    assert np.array_equal(drawn, alone)


def test_where_no_process_starts_one_draws_all(images, alone, monkeypatch):
    def refuses(*_, **__):
        raise OSError("no more processes")

    monkeypatch.setattr(module, "start_python", refuses)
    assert np.array_equal(list(images.drawn(2)), alone)


def test_who_stops_leaves_no_process_behind(images, monkeypatch):
    started, real = [], module._start
    monkeypatch.setattr(module, "_start", lambda *told: started.append(real(*told)) or started[-1])
    drawn = images.drawn(2)
    next(drawn)
    drawn.close()
    assert started[0][0].poll() is not None
