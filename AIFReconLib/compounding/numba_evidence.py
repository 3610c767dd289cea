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
def sample_row(pixels, places, found):
    """Read the pixels at flat `places`, negative ones being dark, as float32."""
    for line in range(places.size):
        place = places[line]
        found[line] = np.float32(pixels[np.uint32(place)]) if place >= 0 else ZERO


@inlined
def add_two_rows(total, one, other):
    """total = (total + one) + other. Few arrays in each loop, here and below, so that compilers make vectors of them."""
    for line in range(total.size):
        total[line] = (total[line] + one[line]) + other[line]


@inlined
def smooth_across(along, per_tap, per_line, across):
    """The mean over three neighboring lines of sums along the lines, not below 0."""
    count = along.size
    for line in range(count):
        along[line] *= per_tap
    across[0] = along[0]
    across[1:] = along[: count - 1]
    add_two_rows(across[: count - 1], along[: count - 1], along[1:])
    across[count - 1] = (across[count - 1] + along[count - 1]) + along[count - 1]
    for line in range(count):
        bright = across[line] * per_line
        across[line] = bright if bright > ZERO else ZERO


@inlined
def largest_below(bright, deeper, per_reached, least, now, arrived, reach):
    """The largest brightness from here on, the share of sound that arrives, and the reach."""
    for line in range(bright.size):
        now[line] = bright[line] if bright[line] > deeper[line] else deeper[line]
    for line in range(bright.size):
        share = now[line] * per_reached
        share = share if share < ONE else ONE
        arrived[line] = share * share
    for line in range(bright.size):
        reach[line] = arrived[line] + least


@inlined
def find_onset(bright, crest, now, later, later_arrived, per_fall, last_echo, per_echo, sample, judged, found):
    """How surely a shadow begins at `sample` of each line, where it is before the line's `judged`."""
    for line in range(bright.size):
        floor = crest[line] if crest[line] > TINY else TINY
        echo = limited((bright[line] / floor - last_echo) * per_echo)
        onset = (limited((now[line] - later[line]) * per_fall) * echo) * (ONE - later_arrived[line])
        found[line] = onset if sample < judged[line] else ZERO


@compiled
def judge(image, pixel_of_sample, taps, depth, crest, judged, scales, reach, onset):
    """Reach and onset of one frame.

    Parameters
    ----------
    image : (rows, columns) uint8 or float32 array, finite
    pixel_of_sample, taps, depth, crest, judged
        Of `ScanLines`.
    scales : tuple of 7 float32
        See `ScanLines.scales`.
    reach, onset : (samples, at least lines) float32 arrays
        Results.

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
        sample_row(pixels, pixel_of_sample[sample], lines[sample % taps])
    for sample in range(samples - 1, -crest - 1, -1):
        if sample >= 0:
            if sample >= half:
                sample_row(pixels, pixel_of_sample[sample - half], lines[(sample - half) % taps])
            along[:] = lines[max(sample - half, 0) % taps]
            for tap in range(1, taps, 2):
                one, other = min(max(sample - half + tap, 0), samples - 1), min(max(sample - half + tap + 1, 0), samples - 1)
                add_two_rows(along, lines[one % taps], lines[other % taps])
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
            np.float32(place),
            judged_before,
            onset[place][:count],
        )
