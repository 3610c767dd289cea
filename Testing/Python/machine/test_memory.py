"""The memory check: what it says, and that its advice is right."""

from __future__ import annotations

import re
import tracemalloc

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from AIFReconLib.bone import field as bone_field
from AIFReconLib.bone import map as bone_map
from AIFReconLib.bone.field import BoneField
from AIFReconLib.bone.map import BoneMap
from AIFReconLib.errors import InsufficientMemoryError
from AIFReconLib.evaluation import surface
from AIFReconLib.evaluation.surface import distance_from_labels
from AIFReconLib.geometry.volume import Volume
from AIFReconLib.guidance.bone import guided_bone
from AIFReconLib.machine import memory
from AIFReconLib.machine.memory import MAXIMUM_VOXELS, available_memory, require_memory

GB = 10**9
HALF = (0.5, 0.5, 0.5)


def advice(size, spacing, bytes_per_voxel, available) -> tuple[str, float | None]:
    """The message, and the spacing that it suggests."""
    with pytest.raises(InsufficientMemoryError) as caught:
        require_memory(size, spacing, bytes_per_voxel, available)
    found = re.search(r"A spacing of ([0-9.]+) mm would fit", str(caught.value))
    return str(caught.value), float(found[1]) if found else None


@given(
    st.tuples(*[st.integers(1, 5000)] * 3),
    st.tuples(*[st.sampled_from([0.05, 0.1, 0.25, 0.5, 1.0, 2.0])] * 3),
    st.integers(1, 40),
    st.sampled_from([10**5, 10**7, 10**9, 10**11]),
)
@settings(max_examples=150)
def test_the_suggested_spacing_passes_for_any_sweep_of_that_size(size, spacing, cost, available):
    try:
        require_memory(size, spacing, cost, available)
    except InsufficientMemoryError as error:
        found = re.search(r"A spacing of ([0-9.]+) mm would fit", str(error))
        if found:
            fits = float(found[1])
            for spare in (0.0, 0.49):
                mm = [(n - 1 + spare) * pitch for n, pitch in zip(size, spacing, strict=True)]
                coarser = tuple(int(length / fits + 0.5 + 1e-6) + 1 for length in mm)
                require_memory(coarser, (fits,) * 3, cost, available)


def test_the_suggested_spacing_is_not_much_coarser_than_it_must_be():
    _, fits = advice((1000, 1000, 1000), HALF, 16, 4 * GB)
    assert (999 * 0.5 / (0.93 * fits)) ** 3 * 16 > 0.9 * 4 * GB
    assert advice((2000, 2000, 50), (0.1, 0.1, 2.0), 16, GB)[1] < 1.0
    require_memory((100, 100, 90), HALF, 10, available=10_000_000)
    advice((100, 100, 91), HALF, 10, 10_000_000)


@pytest.mark.parametrize("available", [10**15, None])
def test_more_voxels_than_can_be_numbered_are_refused_whatever_the_memory(available, monkeypatch):
    monkeypatch.setattr(memory, "available_memory", lambda: None)
    said, fits = advice((2048, 2048, 512), HALF, 1, available)
    assert ("at most 2.1 GB can be used" in said) == (available is None)
    assert (1024 / fits + 1) ** 2 * (256 / fits + 1) <= MAXIMUM_VOXELS


def test_the_least_of_all_limits_counts_and_of_a_container_no_cached_files(monkeypatch, tmp_path):
    monkeypatch.setattr(memory, "_system_free", lambda: 7 * GB)
    (tmp_path / "memory.max").write_text(f"{8 * GB}\n")
    (tmp_path / "memory.stat").write_text(f"anon {GB}\nfile {6 * GB}\ninactive_file {5 * GB}\n")
    monkeypatch.setattr(memory, "CONTROL_GROUP", tmp_path)
    for used, left in ((7, 6), (5, 7), (20, 0)):
        (tmp_path / "memory.current").write_text(f"{used * GB}\n")
        assert available_memory() == left * GB


# ---- what is made of labels


def labeled(n=40):
    array = np.zeros((n, n, n), np.uint8)
    array[5:-5, 5:-5, 5:-5] = 1
    return Volume(array, np.eye(4))


@pytest.mark.parametrize("make", [BoneMap.from_labels, BoneField.from_labels, distance_from_labels, guided_bone])
def test_what_is_made_of_labels_takes_no_more_memory_than_was_asked_for_and_is_refused_before(make, monkeypatch):
    asked = []
    original = memory.require_memory

    def require(size, spacing, each, **options):
        asked.append(np.prod(size) * each)
        original(size, spacing, each, **options)

    for module in (bone_map, bone_field, surface):
        monkeypatch.setattr(module, "require_memory", require)
    tracemalloc.start()
    try:
        make(labeled(96))
        assert tracemalloc.get_traced_memory()[1] < max(asked)
    finally:
        tracemalloc.stop()
    monkeypatch.setattr(memory, "available_memory", lambda: 500_000)
    with pytest.raises(InsufficientMemoryError, match=r"A volume of \d+ x \d+ x \d+ voxels .* needs"):
        make(labeled())
