"""Statistics over points of a surface, each with its area, of which some are not known (NaN)."""

from __future__ import annotations

import numpy as np

from ..arrays import Floats, Reals


def exceeds(a: Floats, b: Floats) -> Floats:
    """1 where a > b, one half where they are equal but for rounding, 0 where a < b, NaN where either is not known."""
    difference = np.where(np.isfinite(a) & np.isfinite(b), a - b, np.nan)
    return np.where(np.abs(difference) <= 1e-5 * np.abs(a), 0.5, (np.sign(difference) + 1) / 2)


def mean_std(values: Reals, weights: Floats | float = 1.0) -> tuple[float, float]:
    """Weighted mean and standard deviation of the values that are not NaN; NaN where there are none."""
    known = np.isfinite(values)
    weights = np.broadcast_to(weights, values.shape)[known]
    total = float(np.sum(weights))
    if total == 0:
        return np.nan, np.nan
    mean = float(np.sum(weights * values[known], dtype=np.float64) / total)
    return mean, float(np.sqrt(np.sum(weights * (values[known] - mean) ** 2, dtype=np.float64) / total))


def median(values: Floats, weights: Floats) -> float:
    """Weighted median of the values that are not NaN; NaN where there are none."""
    known = np.isfinite(values)
    if not known.any():
        return np.nan
    values, weights = values[known], weights[known]
    order = np.argsort(values, kind="stable")
    summed = np.cumsum(weights[order])
    return float(values[order][np.searchsorted(summed, summed[-1] / 2)])


def ratio(numerator: float, denominator: float) -> float:
    """NaN where the denominator is 0 or not known."""
    return numerator / denominator if denominator > 0 else np.nan
