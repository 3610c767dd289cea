"""Two engines, one answer: whatever the sweep, the voxels, the method, the threads and the batches."""

from __future__ import annotations

import sys
import tracemalloc
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sweeps import compounded, oblique_frames, sphere_bone, turned_grid

from AIFReconLib.compounding import batch, engines
from AIFReconLib.compounding.methods.table import LINEAR_METHODS, METHODS
from AIFReconLib.compounding.reconstructor import Reconstructor
from AIFReconLib.errors import SettingsError
from AIFReconLib.geometry.volume import VoxelGrid
from AIFReconLib.imaging.beams import SECTOR, ProbeGeometry
from AIFReconLib.imaging.region import ClipRectangle, Fan, ImageRegion
from AIFReconLib.machine.threads import optional_module
from AIFReconLib.recipe.recipe import ReconstructionSettings

HAS_NUMBA = optional_module("AIFReconLib.compounding.compiled.numba_engine") is not None
needs_numba = pytest.mark.skipif(not HAS_NUMBA, reason="numba is not installed")
REGIONS = (ImageRegion(), ImageRegion(ClipRectangle((2, 1), (28, 22)), Fan((16.0, -6.0), (-40.0, 35.0), (7.0, 29.0))))
WAYS = [*((method, False) for method in METHODS), *((method, True) for method in LINEAR_METHODS)]
"""Methods, and whether pixels are shared between neighbors."""

PROBES = (ProbeGeometry("sector", (16.0, -6.0)), ProbeGeometry("linear"))


def state_after(
    engine, method, frames, grid, *, probe=PROBES[0], region=REGIONS[0], threads=None, chunk=None, linear=False, speed=None, importance=None
):
    """Values, score, hits, mask and best cosine after these frames, given all at once or in chunks."""
    wanted = ReconstructionSettings(
        hole_limit=0.0,
        method=method,
        engine=engine,
        output_type="float32",
        best_cosine=not linear,
        interpolation="linear" if linear else "nearest",
        speed_of_sound=speed,
    )
    bone = None if linear else sphere_bone()
    reconstructor = Reconstructor(grid, wanted, bone, probe=probe, region=region, threads=threads, importance=importance)
    for start in range(0, len(frames), chunk or len(frames)):
        reconstructor.insert(frames[start : start + (chunk or len(frames))])
    result = reconstructor.finish()
    # Along beams of a sector pixels are moved by numpy, and that is said
    by_numpy = engine == "numpy" or (speed is not None and probe.kind == SECTOR and not linear)
    assert reconstructor.engine == ("numpy" if by_numpy else engine)
    assert any("numpy engine" in note for note in result.notes) == (by_numpy and engine != "numpy")
    arrays = [result.intensity.array, result.score.array, result.hits.array, result.mask.array]
    return [*arrays, *([] if linear else [result.cosine.array])], (result.skipped, result.frames_inserted)


@pytest.mark.parametrize(("method", "linear"), WAYS)
def test_frames_that_have_entered_are_let_go(method, linear):
    """A scan of an hour is 100,000 frames: what each leaves behind adds up."""
    frames = oblique_frames(count=60, shape=(60, 80))
    wanted = ReconstructionSettings(method=method, interpolation="linear" if linear else "nearest", best_cosine=not linear)
    reconstructor = Reconstructor(turned_grid(), wanted, None if linear else sphere_bone(), probe=PROBES[0])
    for each in frames:
        reconstructor.insert([each])
    tracemalloc.start()
    try:
        for each in frames:
            reconstructor.insert([each])
        assert tracemalloc.get_traced_memory()[0] < 2000 * len(frames)
    finally:
        tracemalloc.stop()


@needs_numba
@settings(max_examples=80)
@given(
    way=st.sampled_from(WAYS),
    seed=st.integers(0, 10_000),
    spacing=st.tuples(*[st.floats(0.3, 2.5)] * 3),
    turn=st.tuples(*[st.floats(-180, 180)] * 3),
    pixel=st.tuples(st.floats(0.15, 1.2), st.floats(0.15, 1.2)),
    threads=st.integers(1, 5),
    chunk=st.integers(1, 9),
    probe=st.sampled_from(PROBES),
    region=st.sampled_from(REGIONS),
    dtype=st.sampled_from([np.uint8, np.uint16, np.float32]),
    damaged=st.booleans(),
    weighted=st.booleans(),
    speed=st.sampled_from([None, 1480.0]),
)
def test_the_engines_agree_to_the_last_bit(way, seed, spacing, turn, pixel, threads, chunk, probe, region, dtype, damaged, weighted, speed):
    """Of every method, to the nearest voxel or shared between neighbors, and of whatever else can be asked of one."""
    (method, linear), rng = way, np.random.default_rng(seed)
    frames = oblique_frames(seed, count=7, spacing=pixel, dtype=dtype)
    if damaged and dtype == np.float32:
        frames[1].image[rng.random(frames[1].image.shape) < 0.3] = np.nan
    importance = rng.integers(0, 4, frames[0].image.shape).astype(np.float32) / 3 if weighted and method == "average" and linear else None
    grid = turned_grid(spacing, (9, 8, 7), turn)
    asked = {"probe": probe, "region": region, "linear": linear, "speed": speed, "importance": importance}
    plain = state_after("numpy", method, frames, grid, **asked)
    np.testing.assert_equal(state_after("numba", method, frames, grid, threads=threads, chunk=chunk, **asked), plain)


def shadowed_frames(count=4, columns=34):
    """Frames with a bright band and nothing behind it, in every second scan line or so."""
    frames = oblique_frames(count=count, shape=(70, columns), spacing=(0.4, 0.4))
    for frame in frames:
        frame.image[:] //= 3
        frame.image[30:36, ::2] = 250
        frame.image[36:] = 0
        frame.image[60, :: columns // 3] = 255
    return frames


def narrow(columns):
    """Of so many scan lines."""
    return [replace(frame, image=frame.image[:, :columns].copy()) for frame in shadowed_frames(columns=max(columns, 3))]


def changing():
    """The size of a pixel changes amid the sweep."""
    frames = shadowed_frames(count=6)
    return frames[:3] + [replace(f, image_to_reference=f.image_to_reference @ np.diag([1.3, 1.6, 1.0, 1.0])) for f in frames[3:]]


def along_the_grid(frames, spacing, *places):
    """Frames placed without a turn."""
    for number, frame in enumerate(frames):
        frame.image_to_reference[:3, :3] = np.diag(spacing)
        frame.image_to_reference[:3, 3] = places[number % len(places)]
    return frames


def large():
    frames = along_the_grid(oblique_frames(count=3, shape=(150, 300)), (0.1,) * 3, *((-15.0, -7.5, 0.4 * n) for n in range(3)))
    for frame in frames:
        frame.image[:] //= 2
        frame.image[90:] = 0
    return frames


def not_finite():
    frames = oblique_frames(count=4, dtype=np.float32)
    frames[1].image[::3, 1::2] = np.nan
    frames[2].image[5] = np.inf
    return frames


def tilted(tilt):
    """Rows that rounding alone takes out of the volume."""
    heights = np.nextafter(2.5, 0), 2.5, np.nextafter(2.5, 3)
    frames = along_the_grid(oblique_frames(count=3), (0.5,) * 3, *((0.0, 0.0, height) for height in heights))
    for frame in frames:
        frame.image_to_reference[2, 0] = tilt
    return frames


BETWEEN = along_the_grid(oblique_frames(count=3, spacing=(0.25, 0.5)), (0.25, 0.5, 0.4), (-4.0, -6.5, 0.0))
ALIKE = {
    **{f"{columns} scan lines": (narrow(columns), turned_grid(), ["weighted"]) for columns in (1, 2, 3, 16, 34)},
    "more frames than evidence is kept for": (shadowed_frames(count=13), turned_grid(), ["weighted"]),
    "a size of a pixel that changes": (changing(), turned_grid(), ["weighted"]),
    **{
        f"large images, turned by {turn}": (large(), turned_grid((0.31, 0.29, 0.4), (60, 40, 30), (turn, -turn, turn)), METHODS[-2:])
        for turn in (0.0, 20.0)
    },
    "pixels exactly between voxels": (BETWEEN, turned_grid((0.5,) * 3, (20, 20, 3), (0.0, 0.0, 0.0)), METHODS),
    "pixels that are not finite": (not_finite(), turned_grid(), METHODS),
    **{
        f"rows tilted by {tilt}": (tilted(tilt), VoxelGrid.from_spacing((0.0, 0.0, 0.0), (20, 20, 3), 1.0), ["average"])
        for tilt in (-1e-17, 1e-17, 2e-17)
    },
}


@needs_numba
@pytest.mark.parametrize("probe", PROBES, ids=["sector", "linear"])
@pytest.mark.parametrize(("frames", "grid", "methods"), ALIKE.values(), ids=ALIKE)
def test_engines_agree_on_what_is_hard(frames, grid, methods, probe):
    for method in methods:
        plain = state_after("numpy", method, frames, grid, probe=probe)
        assert plain[0][2].any()
        np.testing.assert_equal(state_after("numba", method, frames, grid, probe=probe, threads=2), plain)


@needs_numba
@pytest.mark.parametrize("probe", PROBES, ids=["sector", "linear"])
@pytest.mark.parametrize("way", WAYS)
def test_engines_agree_where_sound_has_another_speed(way, probe):
    """By chance alone, a sector whose pixels are shared came too seldom."""
    (method, linear), frames = way, oblique_frames(count=3)
    plain, fast = (
        state_after(each, method, frames, turned_grid(), probe=probe, linear=linear, speed=1480.0) for each in ("numpy", "numba")
    )
    assert plain[0][2].any()
    np.testing.assert_equal(fast, plain)


@needs_numba
@pytest.mark.parametrize("room", [1, 3, 1000])
def test_the_size_of_a_batch_makes_no_difference(monkeypatch, room):
    frames = oblique_frames(count=8)
    plain = state_after("numpy", "aif-compensated", frames, turned_grid())
    monkeypatch.setattr(batch, "BATCH_BYTES", room * frames[0].image.size)
    np.testing.assert_equal(state_after("numba", "aif-compensated", frames, turned_grid()), plain)


@needs_numba
def test_frames_before_a_failing_one_have_entered():
    def failing():
        yield from oblique_frames(count=3)
        raise OSError("the disk is gone")

    reconstructor = Reconstructor(turned_grid(), ReconstructionSettings(engine="numba"))
    with pytest.raises(OSError, match="disk"):
        reconstructor.insert(failing())
    assert reconstructor.reconstruction().frames_inserted == 3


@needs_numba
def test_an_image_may_change_once_the_next_frame_was_asked_for():
    frames = oblique_frames(count=3)
    straight = state_after("numba", "latest", frames, turned_grid())[0][0]

    def reusing():
        for frame in frames:
            yield frame
            frame.image[:] = 0

    made = compounded(reusing(), method="latest", engine="numba")
    np.testing.assert_array_equal(made.intensity.array, straight)


def test_without_numba_auto_is_numpy_and_asking_for_it_says_how_to_install_it(monkeypatch):
    monkeypatch.setattr(engines, "find_spec", lambda name: None)
    assert engines.choose_engine("auto") == (engines.NumpyEngine, None)
    with pytest.raises(SettingsError, match=r"pip install 'numba>="):
        Reconstructor(turned_grid(), ReconstructionSettings(engine="numba"))


@pytest.fixture
def broken_numba(monkeypatch):
    """A numba that is there and cannot be imported, as one that is too old for its numpy."""
    monkeypatch.setattr(engines, "find_spec", lambda name: object())
    for name in [name for name in sys.modules if name.startswith("AIFReconLib.compounding.compiled.numba_")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.delattr("AIFReconLib.compounding.compiled.numba_engine", raising=False)
    monkeypatch.setitem(sys.modules, "AIFReconLib.machine.numba_compile", None)


def test_a_broken_numba_gives_the_same_volume_and_a_note_and_asking_for_it_an_error(broken_numba):
    reconstructor = Reconstructor(turned_grid(), ReconstructionSettings())
    reconstructor.insert(oblique_frames(count=1))
    assert reconstructor.engine == "numpy"
    assert "numba is installed but does not work" in reconstructor.finish().notes[0]
    with pytest.raises(SettingsError, match=r"does not work .*Reinstall"):
        engines.choose_engine("numba")


@needs_numba
def test_where_no_folder_can_be_written_to_code_is_compiled_all_the_same(monkeypatch):
    from AIFReconLib.machine import numba_compile

    real = numba_compile.njit

    def without_a_folder(**options):
        if options.get("cache"):
            raise RuntimeError("cannot cache function: no locator available")
        return real(**options)

    monkeypatch.setattr(numba_compile, "njit", without_a_folder)
    assert numba_compile.compiled(lambda x: x + 1)(2) == 3
