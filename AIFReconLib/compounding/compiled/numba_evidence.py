"""`ScanLines.evidence` as compiled loops: the same numbers, one pass up the samples instead of one array per step."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...arrays import Bytes, Floats, Integers, Matrix, Numbers, Singles
from ...imaging.gray_levels import GrayLevels
from ...machine.numba_compile import called, compiled, inlined
from ..evidence import UNEXPECTED, Scales, ScanLines
from .groups import Cleared, Corner, Evidence, Expected, Lengths, Places, Results, Room

ZERO, ONE, TWO = np.float32(0), np.float32(1), np.float32(2)
EXTRA = np.float32(UNEXPECTED)
AS_IT_IS = np.arange(256, dtype=np.uint8)


@called
def limited(value: np.float32) -> np.float32:
    """`value` within 0 to 1."""
    value = value if value > ZERO else ZERO
    return value if value < ONE else ONE


@inlined
def copy(numbers: Numbers, room: Numbers) -> None:
    """Copy flat arrays. An assignment of whole arrays would ask at every number whether it is to be spread."""
    for n in range(room.size):
        room[n] = numbers[n]


@inlined
def voxel_at(column: float, row: float, matrix: Matrix, lows: Corner, highs: Corner) -> int:
    """The flat number of the voxel at a place of an image; -1 where that is none of those from `lows` to before `highs`."""
    i = np.floor((matrix[0, 1] * row + (matrix[0, 3] + 0.5)) + matrix[0, 0] * column)
    j = np.floor((matrix[1, 1] * row + (matrix[1, 3] + 0.5)) + matrix[1, 0] * column)
    k = np.floor((matrix[2, 1] * row + (matrix[2, 3] + 0.5)) + matrix[2, 0] * column)
    inside = lows[0] <= i < highs[0] and lows[1] <= j < highs[1] and lows[2] <= k < highs[2]
    return (int(k - lows[2]) * highs[1] + int(j)) * highs[0] + int(i) if inside else -1


@compiled
def number_voxels_at(places: Floats, pixels: Integers, matrix: Matrix, lows: Corner, highs: Corner, voxels: Integers) -> None:
    """Write to `voxels` (n,) int64 what `voxel_at` returns for `pixels` (n,), whose columns and rows are in `places` (2, all) float64."""
    for n in range(voxels.size):
        voxels[n] = voxel_at(places[0, pixels[n]], places[1, pixels[n]], matrix, lows, highs)


@inlined
def read_lines(pixels: Bytes, table: Bytes, places: Integers, lit: Integers, first_lit: Integers, read: Bytes) -> None:
    """Read what `table` (256,) has for the pixels at flat `places` (samples, lines) within the runs `lit`; the rest stays dark."""
    for sample in range(places.shape[0]):
        for run in range(first_lit[sample], first_lit[sample + 1]):
            start, stop = lit[run, 0], lit[run, 1]
            there, found = places[sample, start:stop], read[sample, start:stop]
            for line in range(there.size):
                found[line] = table[pixels[np.uint32(there[line])]]


@inlined
def add_two_rows(total: Singles, one: Numbers, other: Numbers) -> None:
    """total = (total + one) + other. Few arrays in each loop, here and below, so that compilers make vectors of them."""
    for line in range(total.size):
        total[line] = (total[line] + np.float32(one[line])) + np.float32(other[line])


@inlined
def slide_sum(total: Singles, new: Numbers, old: Numbers) -> None:
    """total = total + new - old: of whole numbers, whose sums are exact in any order."""
    for line in range(total.size):
        total[line] += np.float32(new[line]) - np.float32(old[line])


@inlined
def smooth_across(total: Singles, per_tap: np.float32, per_line: np.float32, bright: Singles) -> None:
    """The mean over three neighboring lines of `total`, sums along the lines and of one more line on either side."""
    for line in range(bright.size):
        bright[line] = ((total[line] * per_tap + total[line + 1] * per_tap) + total[line + 2] * per_tap) * per_line


@inlined
def write_reach(bright: Singles, per_reached: np.float32, least: np.float32, most: Singles, reach: Singles) -> None:
    """The reach, of the largest brightness from here on, which `most` is of deeper samples before."""
    for line in range(reach.size):
        most[line] = bright[line] if bright[line] > most[line] else most[line]
        reached = most[line] * per_reached
        reached = reached if reached < ONE else ONE
        reach[line] = reached * reached + least


@inlined
def hand_on_level(
    bright: Singles, kept: np.float32, new: np.float32, behind: Singles, level: Singles, deeper: Singles, largest: Singles
) -> None:
    """The largest level behind this sample and the deeper ones; `level`, which `behind` makes a mean, becomes that behind the sample
    before.
    """
    for line in range(bright.size):
        mean = level[line] * behind[line]
        largest[line] = mean if mean > deeper[line] else deeper[line]
    for line in range(bright.size):
        level[line] = level[line] * kept + new * bright[line]


@inlined
def ask(ct: Expected, matrix: Matrix, place: int, numbers: Integers, believed: Singles) -> None:
    """What the CT says of each line (lines,) at one of the places along them where it is asked; `numbers` is room for that."""
    probability, size, at, of_line = ct
    for n in range(numbers.size):
        numbers[n] = voxel_at(at[0, place, n], at[1, place, n], matrix, (0, 0, 0), size)
    for line in range(believed.size):
        number = numbers[np.uint64(of_line[line])]
        believed[line] = probability[np.uint64(number)] if number >= 0 else ZERO


@inlined
def compare(
    sample: np.float32, judged: Singles, bright: Singles, later: Singles, believed: Singles, scales: Scales, merit: Singles
) -> None:
    """What one sample of each line is worth as its onset; 0 where it is none."""
    per_span, dark, least, tissue, unsure = scales[6], scales[7], scales[8], scales[9], scales[10]
    preference, rival = scales[12], scales[13]
    for line in range(merit.size):
        echo, level, said, end = bright[line], later[line], believed[line], judged[line]
        asked = least - unsure * said
        enough = (echo - level > asked * ((echo + level) + dark)) & (level * per_span < tissue) & (sample < end)
        worth = (echo - preference * level) + rival
        worth = (worth if worth > ZERO else ZERO) * (said + EXTRA)
        merit[line] = worth if enough else ZERO


@inlined
def any_wins(merit: Singles, best: Singles) -> bool:
    """Whether any line has a merit that is as large as the largest so far."""
    found = np.int32(0)
    for line in range(best.size):
        worth, most = merit[line], best[line]
        found += np.int32((worth > ZERO) & (worth >= most))
    return bool(found > 0)


@inlined
def take(better: Singles, least: Singles, new: Singles, old: Singles) -> None:
    """`new` instead of `old` where `better` is at least `least`. All is read before it is asked: so compilers make vectors of it."""
    for line in range(old.size):
        one, other, now, before = better[line], least[line], new[line], old[line]
        old[line] = now if one >= other else before


@inlined
def keep_best(
    sample: np.float32, merit: Singles, later: Singles, believed: Singles, best: Singles, place: Singles, shadow: Singles, trust: Singles
) -> None:
    """The largest merit of each line so far, its sample, the level behind it and what the CT says; of equal ones the shallowest."""
    for line in range(merit.size):
        worth, most, before = merit[line], best[line], place[line]
        place[line] = sample if worth >= most else before
    take(merit, best, later, shadow)
    take(merit, best, believed, trust)
    take(merit, best, merit, best)


@called
def strength_of(echo: np.float32, shadow: np.float32, trust: np.float32, scales: Scales) -> np.float32:
    """How surely an echo over a shadow is bone, where the CT says `trust`."""
    per_span, dark, least, tissue, unsure, per_contrast = scales[6], scales[7], scales[8], scales[9], scales[10], scales[11]
    contrast = (echo - shadow) / ((echo + shadow) + dark) - (least - unsure * trust)
    return limited(contrast * per_contrast) * limited(tissue - shadow * per_span)


@inlined
def hand_out(
    sampled_reach: Singles, sampled_onset: Singles, samples: Integers, reach: Singles, begins: NDArray[np.uint32], onset: Singles
) -> int:
    """Give every pixel the reach at its sample, and write down the pixels with an onset, and the onset; returns how many these are.

    The reach is negative at samples with an onset.
    """
    count = 0
    for pixel in range(samples.size):
        sample = samples[pixel]
        there = sampled_reach[sample]
        if there < ZERO:
            there = -there
            begins[count], onset[count] = pixel, sampled_onset[sample]
            count += 1
        reach[pixel] = there
    return count


@compiled
def judge(
    places: Places,
    table: Bytes,
    ct: Expected,
    matrix: Matrix,
    lengths: Lengths,
    scales: Scales,
    room: Room,
    cleared: Cleared,
    results: Results,
) -> int:
    """Reach and onset of one frame.

    Parameters
    ----------
    table : (256,) uint8 array
        What the levels of the image are on the standard gray scale.
    matrix : (4, 4) float64 array
        From the image to the CT's voxels.
    room : Room
        Best the same every time, so that it is in the cache. It begins with the image.

    Returns
    -------
    onsets : int
        How many of `begins` and `onset` are used.

    Notes
    -----
    One pass up the samples, in rows that lie side by side in memory: an onset is known once a line has been seen whole. The CT is asked
    only where an echo would be the best of its line so far if bone were expected there. Memory comes from the caller, as to compile
    calls of numpy takes numba a second.
    """
    pixel_of_sample, sample_of_pixel, lit, first_lit, active, judged, behind, certain = places
    taps, depth, crest, pace, paces = lengths
    per_tap, per_line, per_reached, least, kept, new = scales[0], scales[1], scales[2], scales[3], scales[4], scales[5]
    reach, begins, onset = results
    samples, count = pixel_of_sample.shape
    half = taps // 2
    pixels, read, sampled_reach, bright, flat_reach, flat_bright, numbers = room
    read_lines(pixels, table, pixel_of_sample, lit, first_lit, read)
    # Sums along the lines, with one more before the first and after the last, so that all have neighbors
    total, largest, of_lines = cleared
    most, level, merit, best, place, shadow, trust, believed = of_lines
    summed, asked_at, ring = False, -1, largest.shape[0]
    for sample in range(samples - 1, -1, -1):
        start, stop = active[sample, 0], active[sample, 1]
        if start >= stop:
            continue
        sums, top = total[start + 1 : stop + 1], max(sample - half, 0)
        if summed and taps > 1:
            slide_sum(sums, read[top, start:stop], read[min(sample + half + 1, samples - 1), start:stop])
        else:
            copy(read[top, start:stop], sums)
            for tap in range(1, taps, 2):
                one, other = min(max(sample - half + tap, 0), samples - 1), min(max(sample - half + tap + 1, 0), samples - 1)
                add_two_rows(sums, read[one, start:stop], read[other, start:stop])
        summed = True
        total[0], total[count + 1] = total[1], total[count]
        here = bright[sample, start:stop]
        smooth_across(total[start : stop + 2], per_tap, per_line, here)
        write_reach(here, per_reached, least, most[start:stop], sampled_reach[sample, start:stop])
        if sample % pace != 0:
            continue
        # A line's first sample has nothing behind: its place in the ring was never written to
        turn = sample // pace
        deeper = largest[(turn + 1) % ring, start:stop]
        hand_on_level(here, kept, new, behind[turn, start:stop], level[start:stop], deeper, largest[turn % ring, start:stop])
        if sample + depth < samples:
            later = largest[(turn + depth // pace) % ring, start:stop]
            worth, before = merit[start:stop], best[start:stop]
            # With less of the CT's word nothing is worth more, to the last bit: rounding keeps order
            compare(np.float32(sample), judged[start:stop], here, later, certain[start:stop], scales, worth)
            if any_wins(worth, before):
                if turn // paces != asked_at:
                    asked_at = turn // paces
                    ask(ct, matrix, asked_at, numbers, believed)
                said = believed[start:stop]
                compare(np.float32(sample), judged[start:stop], here, later, said, scales, worth)
                keep_best(np.float32(sample), worth, later, said, before, place[start:stop], shadow[start:stop], trust[start:stop])
    for line in range(count):
        if best[line] > ZERO:
            middle = int(place[line])
            strength = strength_of(bright[middle, line], shadow[line], trust[line], scales)
            for sample in range(max(middle - crest, 0), min(middle + crest + 1, samples)):
                if active[sample, 0] <= line < active[sample, 1]:
                    bright[sample, line] = strength
                    sampled_reach[sample, line] *= ONE - TWO * np.float32(strength > ZERO)
    return hand_out(flat_reach, flat_bright, sample_of_pixel, reach, begins, onset)


class FrameJudge:
    """Judges frames into arrays that are used again and again: new memory costs as much as what is done in it.

    Parameters
    ----------
    gray_levels : GrayLevels
        What makes of pixels the levels that are judged.
    places : int
        Of how many frames the evidence is kept.
    """

    def __init__(self, scan_lines: ScanLines, gray_levels: GrayLevels, places: int):
        self.scan_lines = lines = scan_lines
        self._gray_levels, self._scales = gray_levels, lines.scales()
        shown = lines.lit, lines.first_lit, lines.active, lines.judged.astype(np.float32), lines.behind
        self._places = lines.pixel_of_sample, lines.padded_sample_of_pixel, *shown, np.ones(lines.shape[1], np.float32)
        self._lengths = lines.taps, lines.depth, lines.crest, lines.pace, lines.paces
        self._reach, self._onset = np.empty((2, places, lines.sample_of_pixel.size), np.float32)
        self._expected, self._cosine = np.empty((2, *self._reach.shape), np.float32)
        self._begins, self._onsets = np.empty(self._reach.shape, np.uint32), np.zeros(places, np.int64)
        self._rooms: list[Room] = []

    def judge(self, image: Numbers, frame: int, probability: Singles, image_to_map: Matrix) -> NDArray[np.uint32]:
        """Judge the image that comes as number `frame` of those that are kept.

        Threads may do so at the same time. `probability` and `image_to_map` are those of `ScanLines.expected`. Returns the numbers of the
        pixels that have an onset, (onsets,).
        """
        lines = self.scan_lines
        try:
            room = self._rooms.pop()
        except IndexError:
            shape = lines.shape[0], lines.padded
            reach, bright = np.empty((2, *shape), np.float32)
            flat, read = np.empty(image.size, np.uint8), np.zeros(shape, np.uint8)
            room = flat, read, reach, bright, reach.reshape(-1), bright.reshape(-1), np.empty(lines.expected_at.shape[2], np.int64)
        # Memory is fast in a row and slow by leaps: so one pass brings the image near before it is read along the beams
        is_8_bit = image.dtype == np.uint8
        np.copyto(room[0], (image if is_8_bit else self._gray_levels.of(image)).reshape(-1))
        table = self._gray_levels.table if is_8_bit else AS_IT_IS
        count = lines.shape[1]
        largest = np.zeros((lines.depth // lines.pace + 1, count), np.float32)
        cleared = np.zeros(count + 2, np.float32), largest, tuple(np.zeros((8, count), np.float32))
        results = self._reach[frame], self._begins[frame], self._onset[frame]
        k, j, i = probability.shape
        ct = probability.reshape(-1), (i, j, k), lines.expected_at, lines.expected_of_line
        onsets = judge(self._places, table, ct, image_to_map, self._lengths, self._scales, room, cleared, results)
        self._rooms.append(room)
        self._onsets[frame] = onsets
        return self._begins[frame, :onsets]

    def voxels_of(self, pixels: NDArray[np.uint32], image_to_ijk: Matrix, lows: Corner, highs: Corner) -> tuple[Integers, Integers]:
        """The voxels of some of the layout's pixels in a part of the grid: positions among the pixels, and flat numbers."""
        voxels = np.empty(pixels.size, np.int64)
        number_voxels_at(self.scan_lines.places, pixels, image_to_ijk, lows, highs, voxels)
        positions = np.flatnonzero(voxels >= 0)
        return positions, voxels[positions]

    def keep(self, frame: int, positions: Integers, expected: Singles, cosine: Singles) -> None:
        """Keep what is known of those of the pixels with an onset at `positions` (m,): the CT's word, and the cosine of incidence."""
        self._expected[frame, positions], self._cosine[frame, positions] = expected, cosine

    def evidence(self, frames: int) -> Evidence:
        """What was found (see `judge`) and kept, (frames, n), and how many onsets, of the first frames."""
        at_onsets = self._begins[:frames], self._onset[:frames], self._expected[:frames], self._cosine[:frames]
        return self._reach[:frames], *at_onsets, self._onsets[:frames]
