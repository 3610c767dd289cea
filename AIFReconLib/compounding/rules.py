"""The arithmetic of the distribution step, in one place.

Every function works in float32, in the order of operations written here, on arrays and on numpy scalars alike: engines and the plain
loop of the tests then agree to the last bit. Symbols are those of Jiang et al., "Insonification Angle-based Ultrasound Volume
Reconstruction for Spine Intervention"; p is the pixel, P = V_prob.
"""

from __future__ import annotations

import numpy as np

ONE = np.float32(1.0)
ZERO = np.float32(0.0)

LARGEST_COMPENSATION = np.float32(3.0)
"""Limit of 1 / cosine in `weighted`: beams beyond 70.5 degrees are raised no further."""


def cosine_of_incidence(beam_x, beam_y, facing_x, facing_y):
    """p_dir . V_dir, with V_dir projected on the image axes (`facing_x`, `facing_y`), limited to 0 to 1.

    A beam has no component across the image plane, so these two products are the whole of it.
    """
    return np.minimum(np.maximum(beam_x * facing_x + beam_y * facing_y, ZERO), ONE)


def facing(direction_x, direction_y, direction_z, axis):
    """V_dir . axis, for a unit vector `axis` (3,) float32 of the image plane in Reference."""
    return (direction_x * axis[0] + direction_y * axis[1]) + direction_z * axis[2]


def paper_angle_weight(cosine, beta, compensated: bool):
    """W_angle: the cosine of incidence, or with compensation its inverse where it exceeds `beta`."""
    if not compensated:
        return cosine
    return np.where(cosine > beta, ONE / np.maximum(cosine, beta), cosine)


def paper_value(pixel, weight, alpha, maximum):
    """v_temp = min(maximum, p + alpha p W), with W = W_angle W_bone."""
    return np.minimum(pixel + (alpha * pixel) * weight, maximum)


def paper_update(value, count, new_value):
    """V = (c V + v_temp) / (c + 1); the caller adds W to c afterwards."""
    return (count * value + new_value) / (count + ONE)


def weighted_gate(onset, probability):
    """G = E P: bone is here when the frame shows the beginning of a shadow and the CT expects bone nearby."""
    return onset * probability


def weighted_weight(gate, reach, floor):
    """Weight of `weighted`: w = (floor + G) R, R the evidence that sound reached the pixel."""
    return (floor + gate) * reach


def weighted_value(pixel, gate, cosine, gain, beta, maximum):
    """Compensated value of `weighted`: min(maximum, p (1 + gain G C)), C = min(1 / cosine, 3) where the cosine exceeds `beta`, else 1.

    Notes
    -----
    Bounded: from p to (1 + 3 gain) p, and 0 stays 0.
    """
    compensation = np.where(cosine > beta, np.minimum(ONE / np.maximum(cosine, beta), LARGEST_COMPENSATION), ONE)
    return np.minimum(pixel * (ONE + (gain * gate) * compensation), maximum)
