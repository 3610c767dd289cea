"""The distribution step with weighted contributions: pixels that spread over the eight voxels around them, or that count unequally.

For average, latest and maximum; compiled where numba is installed, with the same voxels. What a pixel gives to a voxel follows IGSIO.
"""

from __future__ import annotations

import numpy as np

from ..arrays import Floats, Integers, Reals, Singles
from ..errors import SettingsError
from ..machine.threads import optional_module
from ..message import listed
from ..recipe.recipe import Recipe
from .batch import FrameBatch
from .engine import Engine, Job
from .evidence import ScanLines
from .layout import PixelLayout
from .methods.table import LINEAR_METHODS, method_named

CORNERS = np.array([(k, j, i) for i in (0, 1) for j in (0, 1) for k in (0, 1)])
"""The voxels [k, j, i] around a place, from its lower one."""

PIXELS_AT_ONCE = 65_536
"""How many pixels spread at a time: it bounds the memory, and what is used again is still in the cache."""


def uses_shares(settings: Recipe, importance: Reals | None) -> bool:
    """Whether a reconstruction is this engine's."""
    return settings.interpolation == "linear" or importance is not None


def check_shares(method: str, settings: Recipe, importance: Reals | None) -> None:
    """Raise `SettingsError` where linear interpolation or an importance mask does not fit the method."""
    chosen = method_named(method)
    if settings.interpolation == "linear" and (chosen.spread is None or settings.best_cosine):
        wish = f"method {method}" if chosen.spread is None else "the cosine of incidence"
        methods = listed(LINEAR_METHODS, " or ")
        raise SettingsError(f"Input interpolation must be nearest for {wish}; got 'linear'. Leave it out, or choose method {methods}.")
    if importance is not None and (not chosen.weighs_pixels or settings.best_cosine):
        wish = "the cosine of incidence" if chosen.weighs_pixels else f"method {method}"
        raise SettingsError(f"An importance mask weights an average, and does not fit {wish}. Leave it out, or choose method average.")


class SplatEngine(Engine):
    """Puts frames into a `VoxelState` whose pixels spread (interpolation: linear), or count by their importance, or both."""

    def __init__(self, job: Job):
        super().__init__(job)
        if self.method.spread is None:
            raise ValueError(f"Input state must be of a method whose pixels can spread; got {self.method.name}.")
        self._spread_rule = self.method.spread

    def _insert(self, batch: FrameBatch, place: int, layout: PixelLayout, scan_lines: ScanLines | None) -> int:
        values = layout.values(batch.images[place])
        counts = np.ones(len(values), dtype=bool)
        if place in batch.measured:
            counts &= layout.values(batch.measured[place]) > 0
        importance = weights_of(layout, self.job.importance)
        if importance is not None:
            counts &= importance > 0
        image_to_ijk = batch.image_to_ijk[place]
        if self.job.settings.interpolation != "linear":
            pixels, voxels = layout.voxels(image_to_ijk, self.job.grid_size, self.job.planes)
            pixels, voxels = pixels[counts[pixels]], voxels[counts[pixels]]
            self._add(voxels, values[pixels], None if importance is None else importance[pixels])
            return int(pixels.size)
        pixels, entered = np.flatnonzero(counts), 0
        for start in range(0, len(pixels), PIXELS_AT_ONCE):
            some = pixels[start : start + PIXELS_AT_ONCE]
            entered += self._spread(layout.places(image_to_ijk, some), values[some], None if importance is None else importance[some])
        return entered

    def _spread(self, places: Floats, values: Singles, importance: Reals | None) -> int:
        """Pixels at `places` (3, n) float64, [i, j, k] in voxels, enter the voxels around them; returns how many could.

        Notes
        -----
        A corner's share is the product of 1 - distance along each axis. A pixel of which any corner with a share above 0 is outside
        the volume does not enter at all.
        """
        lower = np.floor(places)
        fraction = places - lower
        last = np.array(self.job.grid_size, dtype=np.float64)[:, None] - 1
        inside = ((lower >= 0) & (lower + (fraction > 0) <= last)).all(axis=0)
        if not inside.all():
            lower, fraction, values = lower[:, inside], fraction[:, inside], values[inside]
            importance = None if importance is None else importance[inside]
        if not values.size:
            return 0
        columns, rows, _ = self.job.grid_size
        first = ((lower[2] * rows + lower[1]) * columns + lower[0]).astype(np.int64)
        voxels = first[:, None] + CORNERS @ (rows * columns, columns, 1)
        stored, stop = (plane * rows * columns for plane in self.job.planes)
        i, j, k = (np.stack([1 - along, along]) for along in fraction)
        # In the order of CORNERS, so that a pixel's corners stand side by side and pixels keep their order
        share = (i[:, None, None] * j[None, :, None] * k[None, None]).reshape(8, -1).T
        least = self.method.least_share
        enough = share >= least if least > 0 else share > 0
        enough &= (voxels >= stored) & (voxels < stop)
        pixel = np.nonzero(enough)[0]
        share = share[enough]
        if importance is not None:
            share = share * importance[pixel]
        self._add(voxels[enough] - stored, values[pixel], share)
        return values.size

    def _add(self, voxels: Integers, values: Singles, weights: Reals | None) -> None:
        """Contributions (n,), in order."""
        state = self.state
        np.add.at(state.hits, voxels, np.uint32(1))
        self._spread_rule(state, voxels, values, np.ones(len(values)) if weights is None else weights)


def weights_of(layout: PixelLayout, importance: Reals | None) -> Singles | None:
    """The importance of the pixels that count, (n,) float32; None where all count alike.

    Raises SettingsError when the importance mask is of another size than the images.
    """
    if importance is None:
        return None
    columns, rows = layout.size
    if importance.shape != (rows, columns):
        got = f"{importance.shape[1]} x {importance.shape[0]}"
        raise SettingsError(f"Input importance mask must be as large as the images, {columns} x {rows}; got {got}. Make it anew.")
    return layout.values(importance)


def splat_engine(method: str, settings: Recipe) -> type[Engine]:
    """The compiled engine where pixels spread, the method has a kernel, and numba is there and not ruled out; else `SplatEngine`."""
    wanted = settings.interpolation == "linear" and settings.engine != "numpy"
    module = optional_module("AIFReconLib.compounding.compiled.numba_splat") if wanted else None
    engine: type[Engine] = SplatEngine if module is None or method not in module.SPREAD_RULES else module.NumbaSplatEngine
    return engine
