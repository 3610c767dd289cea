"""Named transforms: names, chains with inverses, statuses, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest
from geometry_strategies import rigid, rigid_poses, scaled
from hypothesis import given, settings
from hypothesis import strategies as st

from AIFReconLib.errors import GeometryError, TransformError
from AIFReconLib.geometry.transform_graph import TransformGraph, TransformName, TransformSample, TransformStatus

IMAGE_TO_PROBE = rigid((0.1, 0.2, -0.3), (5.0, 6.0, 7.0)) @ scaled(0.2, 0.3, 0.25)
PROBE_TO_TRACKER = rigid((1.1, -0.4, 0.2), (100.0, 50.0, -20.0))
REFERENCE_TO_TRACKER = rigid((-0.5, 0.9, 1.4), (-30.0, 10.0, 400.0))


@pytest.fixture
def graph() -> TransformGraph:
    """The usual Plus chain, with a stylus beside it."""
    graph = TransformGraph()
    graph.put("ImageToProbe", IMAGE_TO_PROBE)
    graph.put("ProbeToTracker", PROBE_TO_TRACKER)
    graph.put("ReferenceToTracker", REFERENCE_TO_TRACKER)
    graph.put("StylusToTracker", np.eye(4), TransformStatus.OUT_OF_VIEW)
    return graph


@pytest.mark.parametrize(
    ("text", "source", "target"),
    [
        ("ProbeToTracker", "Probe", "Tracker"),
        ("ProbeToTrackerTransform", "Probe", "Tracker"),
        ("StylusTipToStylus", "StylusTip", "Stylus"),
        ("ToolToTracker", "Tool", "Tracker"),
        ("ToolTipToTool", "ToolTip", "Tool"),
        ("TrackerToTool", "Tracker", "Tool"),
        ("TotalStationToTotem", "TotalStation", "Totem"),
        ("TransducerOriginPixelToImage", "TransducerOriginPixel", "Image"),
        ("ProbeToT", "Probe", "T"),
        ("Probe2ToTracker1", "Probe2", "Tracker1"),
        ("CTToRAS", "CT", "RAS"),
        ("ImageTo3DProbe", "Image", "3DProbe"),
        ("ProbeTo9", "Probe", "9"),
        ("3DProbeTo_tracker", "3DProbe", "_tracker"),
        ("imageToReference", "Image", "Reference"),
        ("probeTo3dTracker", "Probe", "3dTracker"),
    ],
)
def test_a_name_splits_at_its_to(text, source, target):
    assert TransformName.parse(text) == TransformName(source, target)


@pytest.mark.parametrize(
    "text",
    ["", "To", "ToTracker", "ProbeTo", "Probetotracker", "ProbeTotracker", "AToBToC", "ProbeToTransform", "ToAToB", "GoTo Transform"],
)
def test_a_name_that_does_not_say_from_and_to_is_refused(text):
    with pytest.raises(TransformError, match="FromToTo"):
        TransformName.parse(text)


def test_the_path_names_every_link_in_the_direction_of_travel(graph):
    path = graph.lookup("Image", "Reference").path
    assert [str(name) for name in path] == ["ImageToProbe", "ProbeToTracker", "TrackerToReference"]


def test_a_chain_over_ok_links_is_ok_whatever_hangs_beside_it(graph):
    assert graph.lookup("Image", "Reference").status is TransformStatus.OK


@pytest.mark.parametrize("link", ["ImageToProbe", "ProbeToTracker", "ReferenceToTracker"])
@pytest.mark.parametrize("status", [status for status in TransformStatus if status is not TransformStatus.OK])
def test_one_link_that_is_not_ok_makes_the_chain_not_ok(graph, link, status):
    graph.put(link, np.eye(4), status)
    assert graph.lookup("Image", "Reference").status is status


def test_the_first_link_that_is_not_ok_gives_the_status(graph):
    graph.put("ProbeToTracker", np.eye(4), TransformStatus.UNKNOWN)
    graph.put("ReferenceToTracker", np.eye(4), TransformStatus.MISSING)
    assert graph.lookup("Image", "Reference").status is TransformStatus.UNKNOWN


def test_nobody_can_use_the_matrix_of_a_chain_that_is_not_ok(graph):
    assert np.isnan(graph.lookup("Stylus", "Reference").matrix).all()


def test_a_link_that_is_ok_but_not_finite_counts_as_invalid():
    graph = TransformGraph({TransformName("Probe", "Tracker"): TransformSample(np.full((4, 4), np.nan))})
    assert graph.lookup("Tracker", "Probe").status is TransformStatus.INVALID


def test_a_singular_link_that_must_be_inverted_is_an_error_of_the_library():
    graph = TransformGraph({TransformName("Reference", "Tracker"): TransformSample(scaled(1, 1, 0))})
    with pytest.raises(GeometryError, match="singular"):
        graph.lookup("Tracker", "Reference")


def test_two_paths_are_an_error_that_names_both(graph):
    graph.put("ImageToReference", np.eye(4))
    with pytest.raises(TransformError) as caught:
        graph.lookup("Image", "Reference")
    assert "ImageToReference" in str(caught.value)
    assert "ImageToProbe > ProbeToTracker > TrackerToReference" in str(caught.value)


def test_a_second_path_through_other_frames_is_found(graph):
    graph.put("ProbeToStylus", np.eye(4))
    graph.put("StylusToTracker", np.eye(4))
    with pytest.raises(TransformError, match="ProbeToStylus > StylusToTracker"):
        graph.lookup("Image", "Reference")


def test_a_loop_elsewhere_does_not_make_a_path_ambiguous(graph):
    for name in ("StylusTipToStylus", "StylusTipToNeedle", "NeedleToStylus"):
        graph.put(name, np.eye(4))
    assert graph.lookup("Image", "Reference").status is TransformStatus.OK


def test_a_missing_path_says_what_each_end_is_connected_to(graph):
    graph.put("CtToPhantom", np.eye(4))
    with pytest.raises(
        TransformError,
        match=r"from Ct to Reference\..* Ct is connected to Phantom, Reference to Image, Probe, Stylus, Tracker",
    ):
        graph.lookup("Ct", "Reference")


def agreeing(graph: TransformGraph) -> TransformGraph:
    """With everything that a server may compute of the same poses."""
    graph.put("ProbeToReference", np.linalg.inv(REFERENCE_TO_TRACKER) @ PROBE_TO_TRACKER)
    graph.put("TrackerToProbe", np.linalg.inv(PROBE_TO_TRACKER))
    graph.put("ImageToReference", np.linalg.inv(REFERENCE_TO_TRACKER) @ PROBE_TO_TRACKER @ IMAGE_TO_PROBE)
    return graph


def test_ways_that_agree_are_one(graph):
    expected = graph.lookup("Image", "Reference").matrix
    np.testing.assert_allclose(agreeing(graph).lookup("Image", "Reference").matrix, expected, atol=1e-9)


def test_of_ways_that_agree_the_shortest_is_followed(graph):
    assert [str(name) for name in agreeing(graph).lookup("Image", "Reference").path] == ["ImageToReference"]


@pytest.mark.parametrize("link", ["ProbeToTracker", "ReferenceToTracker", "ImageToProbe"])
def test_a_tool_that_is_not_seen_on_any_way_is_told(graph, link):
    agreeing(graph).put(link, np.eye(4), TransformStatus.OUT_OF_VIEW)
    assert graph.lookup("Image", "Reference").status is TransformStatus.OUT_OF_VIEW


@pytest.mark.parametrize("name", ["ProbeToReference", "TrackerToProbe", "ImageToReference", "ProbeToTracker", "ReferenceToTracker"])
def test_one_way_of_many_that_disagrees_is_found(graph, name):
    ends = TransformName.parse(name)
    graph.put(name, rigid((0, 0, 0), (0, 0, 1)) @ agreeing(graph).lookup(ends.source, ends.target).matrix)
    with pytest.raises(TransformError, match=r"Two paths lead from .* They differ by 1 mm"):
        graph.lookup("Image", "Reference")


def test_an_inverse_that_contradicts_is_named_as_it_is_stored(graph):
    graph.put("TrackerToProbe", np.eye(4))
    with pytest.raises(TransformError, match="> ProbeToTracker > TrackerToReference; and ImageToProbe > inverse of TrackerToProbe > "):
        graph.lookup("Image", "Reference")


def test_a_pair_of_inverses_beside_the_way_is_not_asked(graph):
    graph.put("TrackerToStylus", rigid((1, 2, 3), (4, 5, 6)))
    assert graph.lookup("Image", "Reference").status is TransformStatus.OK


@pytest.mark.parametrize("matrix", [np.full((4, 4), np.nan), np.zeros((4, 4)), np.eye(3)])
def test_a_matrix_that_is_no_transform_is_refused_by_name(graph, matrix):
    with pytest.raises(GeometryError, match="ProbeToTracker"):
        graph.put("ProbeToTracker", matrix)


def test_a_graph_does_not_see_later_changes_of_a_matrix(graph):
    matrix = np.eye(4)
    graph.put("CtToReference", matrix)
    matrix[0, 3] = 7.0
    assert graph.lookup("Ct", "Reference").matrix[0, 3] == 0.0


def test_a_tangle_of_frames_is_searched_in_no_time():
    """Every way through it would take years."""
    graph = TransformGraph()
    for a in range(14):
        for b in range(a):
            graph.put(TransformName(f"Tool{a}", f"Tool{b}"), np.eye(4))
    with pytest.raises(TransformError):
        graph.lookup("Tool0", "Nowhere")


@given(st.lists(st.tuples(rigid_poses, st.booleans()), min_size=1, max_size=6))
@settings(max_examples=30)
def test_a_chain_of_any_length_and_direction_equals_the_plain_product(links):
    graph, expected = TransformGraph(), np.eye(4)
    for number, (pose, forward) in enumerate(links):
        here, there = f"Frame{chr(65 + number)}", f"Frame{chr(66 + number)}"
        graph.put(TransformName(here, there) if forward else TransformName(there, here), pose)
        expected = (pose if forward else np.linalg.inv(pose)) @ expected
    np.testing.assert_allclose(graph.lookup("FrameA", f"Frame{chr(65 + len(links))}").matrix, expected, atol=1e-8)
