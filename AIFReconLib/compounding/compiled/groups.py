"""What kernels are given, in groups: plain tuples, which numba tells apart twice as fast as named ones, at every call."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...arrays import Bytes, Floats, Integers, Matrix, Numbers, Reals, Singles

Frames = tuple[Numbers, Matrix, Integers, Integers, Floats]
"""What is inserted. images : (frames, rows, columns) uint8 or float32; matrices, pieces, spans, bounds : as in `clip_to_volume`."""

Whole = int | np.integer
"""Columns and voxels, as they come."""

Slab = tuple[int, int, int]
"""The part of the volume that is filled: axis, first voxel along it, stop."""

Corner = tuple[int, int, int]
"""A voxel, or how many there are, along i, j, k."""

Voxels = tuple[Numbers, NDArray[np.uint32], Reals]
"""value, hits, weight : (voxels,) arrays of the state, `weight` empty where the method has none."""

Bone = tuple[Singles, Singles, Singles, Singles, Singles]
"""Where bone is, and from where it is seen.

probability : (voxels,) float32; directions : (voxels, 3) float32; axes : (frames, 6) float32, the image's x and y axis in Reference;
beam_x, beam_y : (n,) float32, the beams' directions along them.
"""

AifFactors = tuple[np.float32, np.float32, np.float32, bool]
"""alpha, beta and maximum, and whether to compensate."""

WeightedFactors = tuple[np.float32, np.float32, np.float32, np.float32]
"""floor, gain, beta and maximum."""

Evidence = tuple[Singles, NDArray[np.uint32], Singles, Singles, Singles, NDArray[np.int64]]
"""What frames themselves tell.

reach, begins, onset, expected, cosine : (frames, n) arrays, the reach at the pixels; the pixels with an onset, rising, and there the
onset, the probability of bone and the cosine of incidence; onsets : (frames,), how many pixels have one.
"""


def evidence_of(evidence: Evidence, frames: slice) -> Evidence:
    """That of some of the frames."""
    reach, begins, onset, expected, cosine, onsets = evidence
    return reach[frames], begins[frames], onset[frames], expected[frames], cosine[frames], onsets[frames]


SplatFrames = tuple[Numbers, Matrix, Integers, Integers, Integers]
"""What is spread.

images : (frames, rows, columns) uint8 or float32; matrices : (frames, 4, 4) float64, image_to_ijk; pieces : (n, 4) int64;
columns : (frames, n, 2) int32, of each piece the first column that may matter to the slab and the one after the last;
size : (5,) int64, voxels along i, j, k, the first plane of the part that the state is of, and the one after its last.
"""

Pixels = tuple[Floats, Singles]
"""What is known of the layout's pixels.

coordinates : (2, pixels) float64, column and row where they truly are, empty where they are as shown;
importance : (pixels,) float32, empty where all count alike.
"""

Places = tuple[Integers, Integers, Integers, Integers, Integers, Singles, Singles, Singles]
"""pixel_of_sample, padded_sample_of_pixel, lit, first_lit, active, judged, behind : of `ScanLines`; certain : (lines,), ones."""

Lengths = tuple[int, int, int, int, int]
"""taps, depth, crest, pace, paces : of `ScanLines`."""

Expected = tuple[Singles, Corner, Singles, Integers]
"""The CT's word. probability : (voxels,) float32, of a map of size (i, j, k); expected_at, expected_of_line : of `ScanLines`."""

Room = tuple[Bytes, Bytes, Singles, Singles, Singles, Singles, Integers]
"""To work in.

For a copy of the image, flat; for the gray levels at the samples, (samples, padded), 0 at first; for reach and
brightness, then onset, there, (samples, padded) float32, and both once more, flat; for the numbers of the CT's voxels at a place.
"""

Cleared = tuple[Singles, Singles, tuple[Singles, ...]]
"""To work in, 0 at first: (lines + 2,), (depth / pace + 1, lines), and eight of (lines,), float32."""

Results = tuple[Singles, NDArray[np.uint32], Singles]
"""What is found.

reach : (n,), the reach at the layout's pixels; begins, onset : (n,), the numbers of the pixels with an onset, rising, and the onset there.
They are few, and the others need no look.
"""
