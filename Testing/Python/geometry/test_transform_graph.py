"""Named transforms: names, chains with inverses, statuses, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest
from geometry_strategies import IMAGE_TO_PROBE, PROBE_TO_TRACKER, REFERENCE_TO_TRACKER, rigid, rigid_poses, scaled
from hypothesis import given, settings
from hypothesis import strategies as st

from AIFReconLib.errors import GeometryError, TransformError
from AIFReconLib.geometry.transform_graph import TransformName, find_ways

CHAIN = {"ImageToProbe": IMAGE_TO_PROBE, "ProbeToTracker": PROBE_TO_TRACKER, "ReferenceToTracker": REFERENCE_TO_TRACKER}
CHAIN["StylusToTracker"] = np.eye(4)
"""The usual Plus chain, with a stylus beside it."""

SAID_TWICE = {
    **CHAIN,
    "ProbeToReference": np.linalg.inv(REFERENCE_TO_TRACKER) @ PROBE_TO_TRACKER,
    "TrackerToProbe": np.linalg.inv(PROBE_TO_TRACKER),
    "ImageToReference": np.linalg.inv(REFERENCE_TO_TRACKER) @ PROBE_TO_TRACKER @ IMAGE_TO_PROBE,
}
"""With everything that a server may compute of the same poses."""


def ways(transforms, source: str = "Image", target: str = "Reference"):
    return find_ways(map(TransformName.parse, transforms), source, target)


def followed(transforms, source: str = "Image", target: str = "Reference") -> tuple[np.ndarray, list[str]]:
    """The product along the way, and what is said of other ways that disagree."""
    found = ways(transforms, source, target)
    matrix, pairs = found.follow({TransformName.parse(name): one for name, one in transforms.items()})
    return matrix, [found.describe(n) for n, pair in enumerate(pairs) if np.linalg.norm((pair[1] - pair[0]) @ np.ones(4)) > 0.1]


NAMES = {
    "ProbeToTracker": ("Probe", "Tracker"),
    "ProbeToTrackerTransform": ("Probe", "Tracker"),
    "StylusTipToStylus": ("StylusTip", "Stylus"),
    "ToolToTracker": ("Tool", "Tracker"),
    "ToolTipToTool": ("ToolTip", "Tool"),
    "TrackerToTool": ("Tracker", "Tool"),
    "TotalStationToTotem": ("TotalStation", "Totem"),
    "TransducerOriginPixelToImage": ("TransducerOriginPixel", "Image"),
    "ProbeToT": ("Probe", "T"),
    "CTToRAS": ("CT", "RAS"),
    "ImageTo3DProbe": ("Image", "3DProbe"),
    "ProbeTo9": ("Probe", "9"),
    "3DProbeTo_tracker": ("3DProbe", "_tracker"),
    "imageToReference": ("Image", "Reference"),
    "probeTo3dTracker": ("Probe", "3dTracker"),
}


def test_a_name_splits_at_its_to():
    assert {text: TransformName.parse(text) for text in NAMES} == {text: TransformName(*ends) for text, ends in NAMES.items()}


@pytest.mark.parametrize(
    "text",
    ["", "To", "ToTracker", "ProbeTo", "Probetotracker", "ProbeTotracker", "AToBToC", "ProbeToTransform", "ToAToB", "GoTo Transform"],
)
def test_a_name_that_does_not_say_from_and_to_is_refused(text):
    with pytest.raises(TransformError, match="FromToTo"):
        TransformName.parse(text)


def test_a_singular_link_that_must_be_inverted_is_an_error_of_the_library():
    with pytest.raises(GeometryError, match="singular"):
        followed({"ReferenceToTracker": scaled(1, 1, 0)}, "Tracker", "Reference")


def test_a_missing_path_says_what_each_end_is_connected_to():
    said = r"where Ct lies in Reference\..* Ct is connected to Phantom, Reference to Image, Probe, Stylus, Tracker"
    with pytest.raises(TransformError, match=said):
        ways([*CHAIN, "CtToPhantom"], "Ct")


def test_ways_that_agree_are_one_and_the_shortest_is_followed():
    assert [str(link.name) for link in ways(CHAIN).path] == ["ImageToProbe", "ProbeToTracker", "TrackerToReference"]
    assert [str(link.name) for link in ways(SAID_TWICE).path] == ["ImageToReference"]
    matrix, said = followed(SAID_TWICE)
    np.testing.assert_allclose(matrix, followed(CHAIN)[0], atol=1e-9)
    assert said == []


def test_what_hangs_beside_the_path_is_not_asked():
    assert "StylusToTracker" not in map(str, ways(CHAIN).names)
    for beside in (["TrackerToStylus"], ["StylusTipToStylus", "StylusTipToNeedle", "NeedleToStylus"]):
        assert ways([*CHAIN, *beside]).loops == ()


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("ImageToReference", "Image to Reference: ImageToReference; and ImageToProbe > ProbeToTracker > TrackerToReference"),
        ("ProbeToStylus", "ProbeToStylus > StylusToTracker"),
        ("TrackerToProbe", "> ProbeToTracker > TrackerToReference; and ImageToProbe > inverse of TrackerToProbe > "),
    ],
)
def test_two_paths_that_disagree_are_both_named_as_they_are_stored(name, said):
    (found,) = followed({**CHAIN, name: np.eye(4)})[1]
    assert found.startswith("Two paths lead from ")
    assert said in found


@pytest.mark.parametrize("link", ["ProbeToTracker", "ReferenceToTracker", "ImageToProbe"])
def test_no_way_is_left_over_a_tool_that_is_not_seen(link):
    assert ways(SAID_TWICE).without([TransformName.parse(link)]) is None


@pytest.mark.parametrize("name", ["ProbeToReference", "TrackerToProbe", "ImageToReference", "ProbeToTracker", "ReferenceToTracker"])
def test_one_way_of_many_that_disagrees_is_found(name):
    ends = TransformName.parse(name)
    moved = rigid((0, 0, 0), (0, 0, 1)) @ followed(SAID_TWICE, ends.source, ends.target)[0]
    assert followed({**SAID_TWICE, name: moved})[1][0].startswith("Two paths lead from ")


def test_a_tangle_of_frames_is_searched_in_no_time():
    """Every way through it would take years."""
    with pytest.raises(TransformError):
        find_ways([TransformName(f"Tool{a}", f"Tool{b}") for a in range(14) for b in range(a)], "Tool0", "Nowhere")


@given(st.lists(st.tuples(rigid_poses, st.booleans()), min_size=1, max_size=6))
@settings(max_examples=30)
def test_a_chain_of_any_length_and_direction_equals_the_plain_product(links):
    chain, expected = {}, np.eye(4)
    for number, (pose, forward) in enumerate(links):
        here, there = f"Frame{chr(65 + number)}", f"Frame{chr(66 + number)}"
        chain[f"{here}To{there}" if forward else f"{there}To{here}"] = pose
        expected = (pose if forward else np.linalg.inv(pose)) @ expected
    np.testing.assert_allclose(followed(chain, "FrameA", f"Frame{chr(65 + len(links))}")[0], expected, atol=1e-8)
