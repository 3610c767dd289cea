"""`ScanLines.evidence` as compiled loops: the same numbers, without an array for each step."""

from __future__ import annotations

import numpy as np

from ...arrays import Bytes, Integers, Matrix, Numbers, Singles
from ...imaging.gray_levels import GrayLevels
from ...machine.numba_compile import compiled, inlined
from ..evidence import UNEXPECTED, Scales, ScanLines

ZERO, ONE = np.float32(0), np.float32(1)
EXTRA = np.float32(UNEXPECTED)
NO_CT: Singles = np.empty((0, 0, 0), np.float32)
AS_IT_IS = np.arange(256, dtype=np.uint8)

Expected = tuple[Singles, Matrix, Singles, Integers]
"""The CT's word. probability : [k, j, i] float32, empty without a CT; matrix : (4, 4), from the image to its voxels; expected_at,
expected_of_line : of `ScanLines`."""


def judge_frame(
    lines: ScanLines, gray_levels: GrayLevels, values: Numbers, expecting: tuple[Singles | None, Matrix], results: tuple[Singles, Singles]
) -> None:
    """Write the reach and the onset of the layout's pixels, whose values these are, (n,) each.

    Where the CT expects bone is what `lines.expected` returns of `expecting`, its probability and image_to_map; None without a CT.
    """
    is_8_bit, (probability, image_to_map) = values.dtype == np.uint8, expecting
    # The last pixel is for samples that are dark
    pixels = np.zeros(values.size + 1, np.uint8)
    pixels[:-1] = values if is_8_bit else gray_levels.of(values)
    table = gray_levels.table if is_8_bit else AS_IT_IS
    ct = NO_CT if probability is None else probability, image_to_map, lines.expected_at, lines.expected_of_line
    lengths = lines.taps, lines.depth, lines.crest, lines.pace, lines.paces
    places = lines.number_of_sample, lines.sample_of_pixel, lines.judged, lines.behind
    judge(table, places, lengths, lines.scales(), ct, pixels, results)


@inlined
def expected(ct: Expected, turn: int, line: int) -> np.float32:
    """What the CT says at one of the places where it is asked: along the lines, and across them."""
    probability, matrix, at, _of_line = ct
    planes, rows, columns = probability.shape
    if probability.size == 0:
        return ONE
    column, row = at[0, turn, line], at[1, turn, line]
    i = np.floor((matrix[0, 1] * row + (matrix[0, 3] + 0.5)) + matrix[0, 0] * column)
    j = np.floor((matrix[1, 1] * row + (matrix[1, 3] + 0.5)) + matrix[1, 0] * column)
    k = np.floor((matrix[2, 1] * row + (matrix[2, 3] + 0.5)) + matrix[2, 0] * column)
    inside = 0 <= i < columns and 0 <= j < rows and 0 <= k < planes
    return probability[int(k), int(j), int(i)] if inside else ZERO


@compiled
def judge(
    table: Bytes,
    places: tuple[Integers, Integers, Integers, Singles],
    lengths: tuple[int, int, int, int, int],
    scales: Scales,
    ct: Expected,
    pixels: Bytes,
    results: tuple[Singles, Singles],
) -> None:
    """Write the reach and the onset of a frame.

    `table` (256,) says what its gray levels are on the standard scale; `places` are number_of_sample, sample_of_pixel, judged and behind
    of `ScanLines`, `lengths` taps, depth, crest, pace and paces; `pixels` (n + 1,) end with a dark one, and are changed.
    """
    reach, onset = results
    number_of_sample, sample_of_pixel, judged, behind = places
    taps, depth, crest, pace, paces = lengths
    per_tap, per_line, per_reached, least, kept, new, per_span, dark, asked_most, tissue, unsure, per_contrast, preference, rival = scales
    samples, count = number_of_sample.shape
    read, later = np.empty((samples, count), np.uint8), np.empty(behind.shape, np.float32)
    bright, arrived = np.empty((samples, count), np.float32), np.empty((samples, count), np.float32)
    for pixel in range(pixels.size - 1):
        pixels[pixel] = table[pixels[pixel]]
    for sample in range(samples):
        for line in range(count):
            read[sample, line] = pixels[number_of_sample[sample, line]]
    # Sums along the lines, whole numbers, with one more line on either side
    sums, scaled, last = np.zeros(count + 2, np.int32), np.empty(count + 2, np.float32), samples - 1
    for tap in range(taps):
        at = max(last - tap + taps // 2, 0)
        for line in range(count):
            sums[line + 1] += read[min(at, last), line]
    most, level, largest = np.zeros(count, np.float32), np.zeros(count, np.float32), np.zeros(count, np.float32)
    for sample in range(last, -1, -1):
        sums[0], sums[count + 1] = sums[1], sums[count]
        here, there = bright[sample], arrived[sample]
        for line in range(scaled.size):
            scaled[line] = np.float32(sums[line]) * per_tap
        for line in range(here.size):
            here[line] = ((scaled[line] + scaled[line + 1]) + scaled[line + 2]) * per_line
        enters, leaves = read[max(sample - taps // 2 - 1, 0)], read[min(sample + taps // 2, last)]
        for line in range(enters.size):
            sums[line + 1] += np.int32(enters[line]) - np.int32(leaves[line])
        # All is read before it is asked: so compilers make vectors of it
        for line in range(most.size):
            one, other = here[line], most[line]
            most[line] = one if one > other else other
        for line in range(there.size):
            reached = most[line] * per_reached
            reached = reached if reached < ONE else ONE
            there[line] = reached * reached + least
        if sample % pace == 0:
            share, behind_here = behind[sample // pace], later[sample // pace]
            for line in range(largest.size):
                mean, before = level[line] * share[line], largest[line]
                largest[line] = mean if mean > before else before
            for line in range(level.size):
                level[line] = level[line] * kept + new * here[line]
            for line in range(behind_here.size):
                behind_here[line] = largest[line]
    best, strength, place = np.zeros(count, np.float32), np.zeros(count, np.float32), np.zeros(count, np.int64)
    least_asked, of_line = asked_most - unsure, ct[3]
    for turn in range(len(behind) - depth // pace):
        sample, here, there = turn * pace, bright[turn * pace], later[turn + depth // pace]
        for line in range(count):
            echo, shadow = here[line], there[line]
            # With less of the CT's word than all no more is possible, to the last bit: rounding keeps order
            if sample >= judged[line] or shadow * per_span >= tissue or echo - shadow <= least_asked * ((echo + shadow) + dark):
                continue
            belief = expected(ct, turn // paces, of_line[line])
            asked = asked_most - unsure * belief
            worth = max((echo - preference * shadow) + rival, ZERO) * (belief + EXTRA)
            if echo - shadow > asked * ((echo + shadow) + dark) and worth > best[line]:
                best[line], place[line] = worth, sample
                contrast = (echo - shadow) / ((echo + shadow) + dark) - asked
                strength[line] = min(max(contrast * per_contrast, ZERO), ONE) * min(max(tissue - shadow * per_span, ZERO), ONE)
    for line in range(count):
        if strength[line] > ZERO:
            # The reach, which is above 0, turned to below it marks an onset
            for sample in range(max(place[line] - crest, 0), min(place[line] + crest + 1, samples)):
                arrived[sample, line] *= -ONE
                bright[sample, line] = strength[line]
    flat_arrived, flat_strength = arrived.reshape(-1), bright.reshape(-1)
    for pixel in range(reach.size):
        sample = sample_of_pixel[pixel]
        there = flat_arrived[sample]
        reach[pixel] = abs(there)
        onset[pixel] = flat_strength[sample] if there < ZERO else ZERO
