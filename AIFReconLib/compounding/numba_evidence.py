"""`ScanLines.evidence` as compiled loops: the same numbers, one pass up the samples instead of one array per step."""

from __future__ import annotations

import numpy as np

from ..numba_compile import compiled, inlined
from .evidence import ScanLines

ZERO, ONE, TWO = np.float32(0), np.float32(1), np.float32(2)
LINES_AT_ONCE = 128
TINY = np.float32(np.finfo(np.float32).tiny)


@inlined
def limited(value):
    """`value` within 0 to 1."""
    value = value if value > ZERO else ZERO
    return value if value < ONE else ONE


@inlined
def read_lines(pixels, places, lit, first_lit, read):
    """Read the pixels at flat `places` (samples, lines) within the runs `lit`; the rest of `read` stays dark.

    A part of the lines at a time, so that the rows of pixels which they cross stay in the cache from one sample to the next.
    """
    samples, count = places.shape
    for low in range(0, count, LINES_AT_ONCE):
        for sample in range(samples):
            for run in range(first_lit[sample], first_lit[sample + 1]):
                start, stop = max(lit[run, 0], low), min(lit[run, 1], low + LINES_AT_ONCE)
                if start < stop:
                    there, found = places[sample, start:stop], read[sample, start:stop]
                    for line in range(there.size):
                        found[line] = pixels[np.uint32(there[line])]


@inlined
def sum_rows(one, other, third, total):
    """total = (one + other) + third. Few arrays in each loop, here and below, so that compilers make vectors of them."""
    for line in range(total.size):
        total[line] = (np.float32(one[line]) + np.float32(other[line])) + np.float32(third[line])


@inlined
def add_two_rows(total, one, other):
    """total = (total + one) + other."""
    for line in range(total.size):
        total[line] = (total[line] + np.float32(one[line])) + np.float32(other[line])


@inlined
def slide_sum(total, new, old):
    """total = total + new - old: for whole numbers, whose sums are exact in any order."""
    for line in range(total.size):
        total[line] += np.float32(new[line]) - np.float32(old[line])


@inlined
def smooth_across(total, per_tap, per_line, along, across):
    """The mean over three neighboring lines of `total`, sums along the lines, not below 0; `along` gets those along the lines."""
    count = along.size
    for line in range(count):
        along[line] = total[line] * per_tap
    before, here, after, inner = along[: max(count - 2, 0)], along[1 : count - 1], along[2:], across[1 : count - 1]
    for line in range(inner.size):
        bright = ((before[line] + here[line]) + after[line]) * per_line
        inner[line] = bright if bright > ZERO else ZERO
    # Beside the first and the last line lie others like them
    last = count - 1
    bright = ((along[0] + along[0]) + along[min(1, last)]) * per_line
    across[0] = bright if bright > ZERO else ZERO
    bright = ((along[max(last - 1, 0)] + along[last]) + along[last]) * per_line
    across[last] = bright if bright > ZERO else ZERO


@inlined
def largest_below(bright, deeper, per_reached, now, arrived):
    """The largest brightness from here on, and the share of sound that arrives."""
    for line in range(bright.size):
        now[line] = bright[line] if bright[line] > deeper[line] else deeper[line]
    for line in range(bright.size):
        share = now[line] * per_reached
        share = share if share < ONE else ONE
        arrived[line] = share * share


@inlined
def find_onset(bright, crest, now, later, later_arrived, per_fall, last_echo, per_echo, found):
    """How surely a shadow begins at one sample of each line."""
    for line in range(bright.size):
        floor = crest[line] if crest[line] > TINY else TINY
        echo = limited((bright[line] / floor - last_echo) * per_echo)
        found[line] = (limited((now[line] - later[line]) * per_fall) * echo) * (ONE - later_arrived[line])


@inlined
def mark_onset(sample, judged, found, reach):
    """Drop onsets that are not before the line's `judged`, and turn the sign of the reach where one is left.

    Products with 0, 1 and -1 in place of choices, which compilers turn into jumps that processors cannot foresee.
    """
    for line in range(found.size):
        found[line] *= np.float32(sample < judged[line])
    for line in range(found.size):
        reach[line] *= ONE - TWO * np.float32(found[line] > ZERO)


@inlined
def hand_out(sampled_reach, sampled_onset, samples, reach, begins, onset):
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
def judge(image, pixel_of_sample, sample_of_pixel, lit, first_lit, taps, depth, crest, judged, scales, whole, room, reach, begins, onset):
    """Reach and onset of one frame.

    Parameters
    ----------
    image : (rows, columns) uint8 or float32 array, finite
    pixel_of_sample, sample_of_pixel, lit, first_lit, taps, depth, crest, judged
        Of `ScanLines`, `sample_of_pixel` for padded rows.
    scales : tuple of 7 float32
        See `ScanLines.scales`.
    whole : bool
        Whether all pixels are whole numbers, small enough for their sums to be exact.
    room : tuple of arrays
        For a copy of the image, flat; for the pixels at the samples (samples, padded), of the image's type and 0 at first; for reach
        and onset there, (samples, padded) float32. Best the same every time, so that it is in the cache.
    reach : (n,) float32 array
        Result: the reach at the layout's pixels.
    begins, onset : (n,) uint32 and float32 arrays
        Result: the numbers of the pixels with an onset, rising, and the onset there. They are few, and the others need no look.

    Returns
    -------
    onsets : int
        How many of `begins` and `onset` are used.

    Notes
    -----
    Only as many rows as one sample needs are kept beside the results, so that they stay in the cache. Pixels get what is theirs at
    once: later it would no longer be in the cache, and scan lines lie across the rows of the image.
    """
    per_tap, per_line, per_reached, per_fall, last_echo, per_echo, least = scales
    samples, count = pixel_of_sample.shape
    half = taps // 2
    total, along, judged_before = np.empty(count, np.float32), np.empty(count, np.float32), np.empty(count, np.float32)
    judged_before[:] = judged
    pixels, read, sampled_reach, sampled_onset = room
    # Memory is fast in a row and slow by leaps: so one pass brings the image near before it is read along the beams
    pixels[:] = image.ravel()
    read_lines(pixels, pixel_of_sample, lit, first_lit, read)
    # An onset is found `crest` samples late, when what lies before it is known; above the first sample all is as there
    kept = depth + crest + 1
    across, below, arrived = np.empty((kept, count), np.float32), np.zeros((kept, count), np.float32), np.empty((kept, count), np.float32)
    for sample in range(samples - 1, -crest - 1, -1):
        if sample >= 0:
            first_tap = taps if whole and sample < samples - 1 else 1
            for tap in range(first_tap, taps, 2):
                one, other = min(max(sample - half + tap, 0), samples - 1), min(max(sample - half + tap + 1, 0), samples - 1)
                if tap == 1:
                    sum_rows(read[max(sample - half, 0)], read[one], read[other], total)
                else:
                    add_two_rows(total, read[one], read[other])
            if taps == 1:
                total[:] = read[sample, :count]
            elif first_tap == taps:
                slide_sum(total, read[max(sample - half, 0)], read[min(sample + half + 1, samples - 1)])
            here = sample % kept
            smooth_across(total, per_tap, per_line, along, across[here])
            largest_below(across[here], below[(sample + 1) % kept], per_reached, below[here], arrived[here])
        place = sample + crest
        if place >= samples:
            continue
        now, later = place % kept, (place + depth) % kept
        arrives, found = sampled_reach[place][:count], sampled_onset[place][:count]
        for line in range(count):
            arrives[line] = arrived[now][line] + least
        if place + depth < samples:
            shallower, deeper = below[max(sample, 0) % kept], below[later]
            find_onset(across[now], shallower, below[now], deeper, arrived[later], per_fall, last_echo, per_echo, found)
            mark_onset(np.float32(place), judged_before, found, arrives)
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

    def __init__(self, scan_lines: ScanLines, dtype: np.dtype, maximum: float, places: int):
        self.scan_lines = scan_lines
        self._dtype, self._scales = dtype, scan_lines.scales(maximum)
        self._reach, self._onset = np.empty((2, places, scan_lines.sample_of_pixel.size), np.float32)
        self._begins, self._onsets = np.empty(self._reach.shape, np.uint32), np.zeros(places, np.int64)
        self._rooms: list[tuple[np.ndarray, ...]] = []

    def judge(self, image: np.ndarray, frame: int) -> None:
        """Judge the image that comes as number `frame` of those that are kept. Threads may do so at the same time."""
        lines = self.scan_lines
        try:
            room = self._rooms.pop()
        except IndexError:
            shape = lines.shape[0], lines.padded
            read = np.empty(image.size, self._dtype), np.zeros(shape, self._dtype)
            room = *read, np.empty(shape, np.float32), np.empty(shape, np.float32)
        where = lines.pixel_of_sample, lines.padded_sample_of_pixel, lines.lit, lines.first_lit
        lengths = lines.taps, lines.depth, lines.crest, lines.judged
        results = self._reach[frame], self._begins[frame], self._onset[frame]
        self._onsets[frame] = judge(image, *where, *lengths, self._scales, self._dtype == np.uint8, room, *results)
        self._rooms.append(room)

    def evidence(self, frames: int) -> tuple[np.ndarray, ...]:
        """Reach, pixels with an onset, and onset (see `judge`), (frames, n), and how many onsets, of the first frames."""
        return self._reach[:frames], self._begins[:frames], self._onset[:frames], self._onsets[:frames]
