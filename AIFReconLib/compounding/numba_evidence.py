"""`ScanLines.evidence` as compiled loops: the same numbers, one pass up the samples instead of one array per step."""

from __future__ import annotations

import numpy as np

from ..numba_compile import compiled, inlined

ZERO, ONE = np.float32(0), np.float32(1)
TINY = np.float32(np.finfo(np.float32).tiny)


@inlined
def limited(value):
    """`value` within 0 to 1."""
    value = value if value > ZERO else ZERO
    return value if value < ONE else ONE


@inlined
def sample_row(pixels, places, lit, first, stop, found):
    """Read the pixels at flat `places` of the lines within `lit[first:stop]` as float32; all others are dark."""
    for line in range(found.size):
        found[line] = ZERO
    for run in range(first, stop):
        start, end = lit[run, 0], lit[run, 1]
        there, some = places[start:end], found[start:end]
        for line in range(some.size):
            some[line] = pixels[np.uint32(there[line])]


@inlined
def sum_rows(one, other, third, total):
    """total = (one + other) + third. Few arrays in each loop, here and below, so that compilers make vectors of them."""
    for line in range(total.size):
        total[line] = (one[line] + other[line]) + third[line]


@inlined
def add_two_rows(total, one, other):
    """total = (total + one) + other."""
    for line in range(total.size):
        total[line] = (total[line] + one[line]) + other[line]


@inlined
def smooth_across(along, per_tap, per_line, across):
    """The mean over three neighboring lines of sums along the lines, not below 0."""
    count = along.size
    for line in range(count):
        along[line] *= per_tap
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
def largest_below(bright, deeper, per_reached, least, now, arrived, reach):
    """The largest brightness from here on, the share of sound that arrives, and the reach."""
    for line in range(bright.size):
        now[line] = bright[line] if bright[line] > deeper[line] else deeper[line]
    for line in range(bright.size):
        share = now[line] * per_reached
        share = share if share < ONE else ONE
        arrived[line] = share * share
        reach[line] = share * share + least


@inlined
def find_onset(bright, crest, now, later, later_arrived, per_fall, last_echo, per_echo, found):
    """How surely a shadow begins at one sample of each line."""
    for line in range(bright.size):
        floor = crest[line] if crest[line] > TINY else TINY
        echo = limited((bright[line] / floor - last_echo) * per_echo)
        found[line] = (limited((now[line] - later[line]) * per_fall) * echo) * (ONE - later_arrived[line])


@inlined
def mark_onset(sample, judged, found, reach):
    """Drop onsets that are not before the line's `judged`, and turn the sign of the reach where one is left."""
    for line in range(found.size):
        onset = found[line] if sample < judged[line] else ZERO
        found[line] = onset
        reach[line] = -reach[line] if onset > ZERO else reach[line]


@compiled
def judge(image, pixel_of_sample, lit, first_lit, taps, depth, crest, judged, scales, reach, onset):
    """Reach and onset of one frame.

    Parameters
    ----------
    image : (rows, columns) uint8 or float32 array, finite
    pixel_of_sample, lit, first_lit, taps, depth, crest, judged
        Of `ScanLines`.
    scales : tuple of 7 float32
        See `ScanLines.scales`.
    reach, onset : (samples, at least lines) float32 arrays
        Results; reach is negative where there is an onset, and onset is found there alone: the other samples need one look, not two.

    Notes
    -----
    Only as many rows as one sample needs are kept beside the results, so that they stay in the cache.
    """
    per_tap, per_line, per_reached, per_fall, last_echo, per_echo, least = scales
    samples, count = pixel_of_sample.shape
    half, pixels = taps // 2, image.ravel()
    along, judged_before = np.empty(count, np.float32), np.empty(count, np.float32)
    judged_before[:] = judged
    lines = np.empty((taps, count), np.float32)
    # An onset is found `crest` samples late, when what lies before it is known; above the first sample all is as there
    kept = depth + crest + 1
    across, below, arrived = np.empty((kept, count), np.float32), np.zeros((kept, count), np.float32), np.empty((kept, count), np.float32)
    for sample in range(max(samples - half, 0), samples):
        sample_row(pixels, pixel_of_sample[sample], lit, first_lit[sample], first_lit[sample + 1], lines[sample % taps])
    for sample in range(samples - 1, -crest - 1, -1):
        if sample >= 0:
            if sample >= half:
                new = sample - half
                sample_row(pixels, pixel_of_sample[new], lit, first_lit[new], first_lit[new + 1], lines[new % taps])
            for tap in range(1, taps, 2):
                one, other = min(max(sample - half + tap, 0), samples - 1), min(max(sample - half + tap + 1, 0), samples - 1)
                if tap == 1:
                    sum_rows(lines[max(sample - half, 0) % taps], lines[one % taps], lines[other % taps], along)
                else:
                    add_two_rows(along, lines[one % taps], lines[other % taps])
            if taps == 1:
                along[:] = lines[0]
            here = sample % kept
            smooth_across(along, per_tap, per_line, across[here])
            largest_below(across[here], below[(sample + 1) % kept], per_reached, least, below[here], arrived[here], reach[sample][:count])
        place = sample + crest
        if place >= samples:
            continue
        if place + depth >= samples:
            onset[place][:count] = ZERO
            continue
        now, later = place % kept, (place + depth) % kept
        find_onset(
            across[now],
            below[max(sample, 0) % kept],
            below[now],
            below[later],
            arrived[later],
            per_fall,
            last_echo,
            per_echo,
            onset[place][:count],
        )
        mark_onset(np.float32(place), judged_before, onset[place][:count], reach[place][:count])
