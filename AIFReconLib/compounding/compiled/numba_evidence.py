"""`ScanLines.evidence` as compiled loops: the same numbers, one pass up the samples instead of one array per step."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...arrays import Integers, Numbers, NumberType, Singles
from ...machine.numba_compile import compiled, inlined
from ..evidence import Scales, ScanLines
from .groups import Evidence, Lengths, Places, Results, Room

ZERO, ONE, TWO = np.float32(0), np.float32(1), np.float32(2)
TINY = np.float32(np.finfo(np.float32).tiny)


@inlined
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
def read_lines(pixels: Numbers, places: Integers, lit: Integers, first_lit: Integers, read: Numbers) -> None:
    """Read the pixels at flat `places` (samples, lines) within the runs `lit`; the rest of `read` stays dark."""
    for sample in range(places.shape[0]):
        for run in range(first_lit[sample], first_lit[sample + 1]):
            start, stop = lit[run, 0], lit[run, 1]
            there, found = places[sample, start:stop], read[sample, start:stop]
            for line in range(there.size):
                found[line] = pixels[np.uint32(there[line])]


@inlined
def sum_rows(one: Numbers, other: Numbers, third: Numbers, total: Singles) -> None:
    """total = (one + other) + third. Few arrays in each loop, here and below, so that compilers make vectors of them."""
    for line in range(total.size):
        total[line] = (np.float32(one[line]) + np.float32(other[line])) + np.float32(third[line])


@inlined
def add_two_rows(total: Singles, one: Numbers, other: Numbers) -> None:
    """total = (total + one) + other."""
    for line in range(total.size):
        total[line] = (total[line] + np.float32(one[line])) + np.float32(other[line])


@inlined
def slide_sum(total: Singles, new: Numbers, old: Numbers) -> None:
    """total = total + new - old: for whole numbers, whose sums are exact in any order."""
    for line in range(total.size):
        total[line] += np.float32(new[line]) - np.float32(old[line])


@inlined
def smooth_across(total: Singles, per_tap: np.float32, per_line: np.float32, deeper: Singles, bright: Singles, now: Singles) -> None:
    """The mean over three neighboring lines of `total`, sums along the lines and of one more line on either side, not below 0.

    And the largest brightness from here on, `now`, of that and `deeper`.
    """
    for line in range(bright.size):
        mean = ((total[line] * per_tap + total[line + 1] * per_tap) + total[line + 2] * per_tap) * per_line
        mean = mean if mean > ZERO else ZERO
        bright[line] = mean
        now[line] = mean if mean > deeper[line] else deeper[line]


@inlined
def arrived(now: np.float32, per_reached: np.float32) -> np.float32:
    """How much of the sound arrives, 0 to 1."""
    reached = now * per_reached
    reached = reached if reached < ONE else ONE
    return reached * reached


@inlined
def write_reach(now: Singles, per_reached: np.float32, least: np.float32, reach: Singles) -> None:
    """The reach, of the largest brightness from here on."""
    for line in range(reach.size):
        reach[line] = arrived(now[line], per_reached) + least


@inlined
def find_onset(bright: Singles, crest: Singles, now: Singles, later: Singles, scales: Scales, found: Singles) -> None:
    """How surely a shadow begins at one sample of each line."""
    _, _, per_reached, per_fall, last_echo, per_echo, _ = scales
    for line in range(found.size):
        floor = crest[line] if crest[line] > TINY else TINY
        echo = limited((bright[line] / floor - last_echo) * per_echo)
        found[line] = (limited((now[line] - later[line]) * per_fall) * echo) * (ONE - arrived(later[line], per_reached))


@inlined
def mark_onset(sample: np.float32, judged: Singles, found: Singles, reach: Singles) -> None:
    """Drop onsets that are not before the line's `judged`, and turn the sign of the reach where one is left.

    Products with 0, 1 and -1 in place of choices, which compilers turn into jumps that processors cannot foresee.
    """
    for line in range(found.size):
        found[line] *= np.float32(sample < judged[line])
    for line in range(found.size):
        reach[line] *= ONE - TWO * np.float32(found[line] > ZERO)


@inlined
def hand_out(
    sampled_reach: Singles, sampled_onset: Singles, samples: Integers, reach: Singles, begins: NDArray[np.uint32], onset: Singles
) -> int:
    """Give every pixel the reach at its sample, and write down the pixels with an onset, and the onset; returns how many these are."""
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
def judge(image: Numbers, places: Places, lengths: Lengths, scales: Scales, whole: bool, room: Room, results: Results) -> int:
    """Reach and onset of one frame.

    Parameters
    ----------
    image : (rows, columns) uint8 or float32 array, finite
    places : Places
    lengths : Lengths
    scales : Scales
    whole : bool
        Whether all pixels are whole numbers, small enough for their sums to be exact.
    room : Room
        Best the same every time, so that it is in the cache.
    results : Results

    Returns
    -------
    onsets : int
        How many of `begins` and `onset` are used.

    Notes
    -----
    Only as many rows as one sample needs are kept beside the results, so that they stay in the cache. Pixels get what is theirs at
    once: later it would no longer be in the cache, and scan lines lie across the rows of the image.
    """
    pixel_of_sample, sample_of_pixel, lit, first_lit, active, judged = places
    taps, depth, crest = lengths
    per_tap, per_line, per_reached, _, _, _, least = scales
    reach, begins, onset = results
    samples, count = pixel_of_sample.shape
    half = taps // 2
    judged_before = judged.astype(np.float32)
    pixels, read, sampled_reach, sampled_onset = room
    # Memory is fast in a row and slow by leaps: so one pass brings the image near before it is read along the beams
    copy(image.ravel(), pixels)
    read_lines(pixels, pixel_of_sample, lit, first_lit, read)
    # Sums along the lines, with one more before the first and after the last, so that all have neighbors
    total = np.zeros(count + 2, np.float32)
    summed = False
    # An onset is found `crest` samples late, when what lies before it is known; above the first sample all is as there
    kept = depth + crest + 1
    bright, below = np.zeros((kept, count), np.float32), np.zeros((kept, count), np.float32)
    for sample in range(samples - 1, -crest - 1, -1):
        if sample >= 0 and active[sample, 0] < active[sample, 1]:
            start, stop = active[sample, 0], active[sample, 1]
            sums, top = total[start + 1 : stop + 1], max(sample - half, 0)
            first_tap = taps if whole and summed else 1
            for tap in range(first_tap, taps, 2):
                one, other = min(max(sample - half + tap, 0), samples - 1), min(max(sample - half + tap + 1, 0), samples - 1)
                if tap == 1:
                    sum_rows(read[top, start:stop], read[one, start:stop], read[other, start:stop], sums)
                else:
                    add_two_rows(sums, read[one, start:stop], read[other, start:stop])
            if taps == 1:
                copy(read[sample, start:stop], sums)
            elif first_tap == taps:
                slide_sum(sums, read[top, start:stop], read[min(sample + half + 1, samples - 1), start:stop])
            summed = True
            total[0], total[count + 1] = total[1], total[count]
            here, deeper = sample % kept, (sample + 1) % kept
            smooth_across(
                total[start : stop + 2], per_tap, per_line, below[deeper, start:stop], bright[here, start:stop], below[here, start:stop]
            )
            write_reach(below[here, start:stop], per_reached, least, sampled_reach[sample, start:stop])
        place = sample + crest
        if place + depth < samples:
            start, stop = active[place, 0], active[place, 1]
            now, later, shallower = place % kept, (place + depth) % kept, max(sample, 0) % kept
            found = sampled_onset[place, start:stop]
            find_onset(
                bright[now, start:stop],
                below[shallower, start:stop],
                below[now, start:stop],
                below[later, start:stop],
                scales,
                found,
            )
            mark_onset(np.float32(place), judged_before[start:stop], found, sampled_reach[place, start:stop])
    return hand_out(sampled_reach.ravel(), sampled_onset.ravel(), sample_of_pixel, reach, begins, onset)


class FrameJudge:
    """Judges frames into arrays that are used again and again: new memory costs as much as what is done in it.

    Parameters
    ----------
    scan_lines : ScanLines
    dtype : dtype of the images
    maximum : float
        Brightest value an image can hold.
    places : int
        Of how many frames the evidence is kept.
    """

    def __init__(self, scan_lines: ScanLines, dtype: NumberType, maximum: float, places: int):
        self.scan_lines = scan_lines
        self._dtype, self._scales = dtype, scan_lines.scales(maximum)
        self._reach, self._onset = np.empty((2, places, scan_lines.sample_of_pixel.size), np.float32)
        self._begins, self._onsets = np.empty(self._reach.shape, np.uint32), np.zeros(places, np.int64)
        self._rooms: list[Room] = []

    def judge(self, image: Numbers, frame: int) -> None:
        """Judge the image that comes as number `frame` of those that are kept. Threads may do so at the same time."""
        lines = self.scan_lines
        try:
            room = self._rooms.pop()
        except IndexError:
            shape = lines.shape[0], lines.padded
            flat, read = np.empty(image.size, self._dtype), np.zeros(shape, self._dtype)
            room = flat, read, np.empty(shape, np.float32), np.empty(shape, np.float32)
        places = lines.pixel_of_sample, lines.padded_sample_of_pixel, lines.lit, lines.first_lit, lines.active, lines.judged
        lengths = lines.taps, lines.depth, lines.crest
        results = self._reach[frame], self._begins[frame], self._onset[frame]
        self._onsets[frame] = judge(image, places, lengths, self._scales, self._dtype == np.uint8, room, results)
        self._rooms.append(room)

    def evidence(self, frames: int) -> Evidence:
        """Reach, pixels with an onset, and onset (see `judge`), (frames, n), and how many onsets, of the first frames."""
        return self._reach[:frames], self._begins[:frames], self._onset[:frames], self._onsets[:frames]
