"""The arithmetic of the distribution step, in one place.

Every function works in float32, in the order of operations written here, on arrays and on numpy scalars alike: engines and the plain
loop of the tests then agree to the last bit. Symbols are those of Jiang et al., "Insonification Angle-based Ultrasound Volume
Reconstruction for Spine Intervention"; p is the pixel, P = V_prob.
"""

from __future__ import annotations

import numpy as np

from ...arrays import Singles

ONE = np.float32(1.0)
ZERO = np.float32(0.0)

LARGEST_COMPENSATION = np.float32(3.0)
"""Limit of 1 / cosine in `weighted`: beams beyond 70.5 degrees are raised no further."""


def cosine_of_incidence(beam_x: Singles, beam_y: Singles, facing_x: Singles, facing_y: Singles) -> Singles:
    """p_dir . V_dir, with V_dir projected on the image axes (`facing_x`, `facing_y`), limited to 0 to 1.

    A beam has no component across the image plane, so these two products are the whole of it.
    """
    cosine: Singles = np.minimum(np.maximum(beam_x * facing_x + beam_y * facing_y, ZERO), ONE)
    return cosine


def facing(direction_x: Singles, direction_y: Singles, direction_z: Singles, axis: Singles) -> Singles:
    """V_dir . axis, for a unit vector `axis` (3,) float32 of the image plane in Reference."""
    along: Singles = (direction_x * axis[0] + direction_y * axis[1]) + direction_z * axis[2]
    return along


def paper_angle_weight(cosine: Singles, beta: np.float32, compensated: bool) -> Singles:
    """W_angle: the cosine of incidence, or with compensation its inverse where it exceeds `beta`."""
    if not compensated:
        return cosine
    return np.where(cosine > beta, ONE / np.maximum(cosine, beta), cosine)


def paper_value(pixel: Singles, weight: Singles, alpha: np.float32, maximum: np.float32) -> Singles:
    """v_temp = min(maximum, p + alpha p W), with W = W_angle W_bone."""
    value: Singles = np.minimum(pixel + (alpha * pixel) * weight, maximum)
    return value


def paper_update(value: Singles, count: Singles, new_value: Singles) -> Singles:
    """V = (c V + v_temp) / (c + 1); the caller adds W to c afterwards."""
    return (count * value + new_value) / (count + ONE)


def weighted_gate(onset: Singles, probability: Singles) -> Singles:
    """G = E P^2: bone is here when the frame shows the beginning of a shadow and the CT expects bone close by."""
    return (onset * probability) * probability


def weighted_weight(gate: Singles, reach: Singles, floor: np.float32) -> Singles:
    """Weight of `weighted`: w = (floor + G) R, R the evidence that sound reached the pixel."""
    return (floor + gate) * reach


def weighted_compensation(cosine: Singles, beta: np.float32) -> Singles:
    """C = min(1 / cosine, 3) where the cosine exceeds `beta`, else 1."""
    return np.where(cosine > beta, np.minimum(ONE / np.maximum(cosine, beta), LARGEST_COMPENSATION), ONE)


def weighted_value(pixel: Singles, gate: Singles, compensation: Singles, gain: np.float32, maximum: np.float32) -> Singles:
    """Compensated value of `weighted`: min(maximum, p (1 + gain G C)).

    Notes
    -----
    Bounded: from p to (1 + 3 gain) p, and 0 stays 0.
    """
    value: Singles = np.minimum(pixel * (ONE + (gain * gate) * compensation), maximum)
    return value
