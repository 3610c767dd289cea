"""What `make fuzz` checks, for a few seconds: every input is refused in one sentence or gives a well-formed result."""

from __future__ import annotations

import random
import sys
import time
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

TESTING = Path(__file__).resolve().parents[2]
if str(TESTING) not in sys.path:
    sys.path.insert(0, str(TESTING))

from fuzz import target as fuzz_target  # noqa: E402
from fuzz.corpus import CORPUS, read_corpus, write_corpus  # noqa: E402
from fuzz.mutation import LARGEST, mutate  # noqa: E402
from fuzz.registry import TARGETS  # noqa: E402
from fuzz.target import LONGEST_MESSAGE, Finding, Target, check  # noqa: E402

from AIFReconLib.errors import FileFormatError  # noqa: E402

INPUTS = read_corpus()
NEEDED = {
    "pictures": "PIL",
    "dicom": "pydicom",
    "tiff": "tifffile",
    "settings-toml": "tomllib",
    **dict.fromkeys(("sequence-ros-1", "sequence-mcap", "sequence-ros-2"), "rosbags"),
}


@pytest.fixture
def folder(tmp_path):
    """Where inputs are written; beside them lies the data file that detached headers name."""
    (tmp_path / "data.raw").write_bytes(bytes(range(24)) * 3)
    return tmp_path


@pytest.fixture(params=list(TARGETS))
def target(request):
    pytest.importorskip(NEEDED.get(request.param, "numpy"), reason="the package for this kind of image is not installed")
    return TARGETS[request.param]


def test_every_input_of_the_corpus_is_accepted_or_refused(target, folder):
    assert INPUTS[target.name]
    for data in INPUTS[target.name]:
        check(target, data, folder)


def test_good_inputs_are_accepted(target, folder):
    """Otherwise nothing behind the first refusal would ever be reached."""
    accepted = [check(target, data, folder) for data in target.seeds()]
    assert sum(accepted) >= len(accepted) / 2


def test_damaged_inputs_are_accepted_or_refused(target, folder):
    seeds = target.seeds()

    slow = target.name.startswith("command")

    @settings(max_examples=10 if slow else 30, derandomize=True, suppress_health_check=list(HealthCheck))
    @given(st.sampled_from(seeds), st.integers(0, 2**32))
    def damage(data, number):
        check(target, mutate(data, random.Random(number), target.words, seeds), folder)

    damage()


def test_the_corpus_is_small_and_the_same_inputs_make_the_same_file(tmp_path):
    write_corpus(INPUTS, tmp_path / "again.zip")
    assert read_corpus(tmp_path / "again.zip") == INPUTS
    write_corpus(INPUTS, tmp_path / "corpus.zip")
    assert (tmp_path / "corpus.zip").read_bytes() == (tmp_path / "again.zip").read_bytes()
    assert CORPUS.stat().st_size < 2**20
    assert set(INPUTS) == set(TARGETS)


# ---- the check itself can fail


def reader(read) -> Target:
    return Target("own", "input.bin", read, lambda: [b""])


class Unclean(FileFormatError):
    """Says just what it is given, which errors of the library do not."""

    def __init__(self, text):
        super().__init__(text)
        self.text = text

    def __str__(self):
        return self.text


def raising(error):
    def read(path):
        raise error

    return read


@pytest.mark.parametrize(
    ("error", "kind"),
    [
        (KeyError("size"), "KeyError at test_fuzz_corpus.py:read"),
        (AssertionError(), "AssertionError at"),
        (Unclean("two\nlines"), "message of"),
        (Unclean(""), "message of"),
        (Unclean("long " * LONGEST_MESSAGE), "message of"),
        (Unclean("\x1b[2J"), "message of"),
        (UserWarning("numpy says"), "UserWarning at"),
    ],
)
def test_what_is_no_refusal_in_one_line_is_found(folder, error, kind):
    with pytest.raises(Finding) as caught:
        check(reader(raising(error)), b"", folder)
    assert caught.value.kind.startswith(kind)


def test_a_refusal_is_not_found(folder):
    assert not check(reader(raising(FileFormatError("ct.nrrd: it is damaged. Copy it again."))), b"", folder)


def test_what_takes_too_long_is_found(folder, monkeypatch):
    monkeypatch.setattr(fuzz_target, "SLOWEST", 0.01)
    monkeypatch.setattr(fuzz_target, "QUICK", 0.0)

    def work(path):
        end = time.process_time() + 0.05
        while time.process_time() < end:
            pass

    with pytest.raises(Finding, match="slow"):
        check(reader(work), b"", folder)


def test_what_takes_too_much_memory_is_found(folder, monkeypatch):
    monkeypatch.setattr(fuzz_target, "QUICK", 0.0)
    seen = iter((2**30, 2**31))
    monkeypatch.setattr(fuzz_target, "peak_memory", lambda: next(seen))
    with pytest.raises(Finding, match="memory"):
        check(reader(lambda path: None), b"", folder)


@given(st.binary(max_size=300), st.integers(0, 2**32))
def test_damage_depends_on_its_number_alone_and_stays_small(data, number):
    first, again = (mutate(data, random.Random(number), (b"word",), [b"a\nb", b"c"]) for _ in range(2))
    assert first == again
    assert len(first) <= LARGEST
