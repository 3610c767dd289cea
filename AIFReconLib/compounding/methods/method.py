"""What a method is: all that the rest of the library asks of one."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, NamedTuple, Protocol

import numpy as np

from ...arrays import Integers, Numbers, Reals, Singles
from . import rules

Reading = Literal["nowhere", "at onsets", "everywhere"]
"""Where a method looks at the bone map: at pixels with which a shadow begins alone, or wherever a pixel enters."""


class Beams(NamedTuple):
    """The beams through pixels of a frame: their components along its axes, (m,), and these axes, (3,) in Reference."""

    x: Singles
    y: Singles
    x_axis: Singles
    y_axis: Singles

    def of_pixels(self, pixels: Integers) -> Beams:
        """Some of them."""
        return Beams(self.x[pixels], self.y[pixels], self.x_axis, self.y_axis)

    def cosine(self, directions: Singles) -> Singles:
        """Cosine of incidence of pixels in voxels with these `directions` (m, 3) of bone, (m,)."""
        x, y, z = directions.T
        return rules.cosine_of_incidence(self.x, self.y, rules.facing(x, y, z, self.x_axis), rules.facing(x, y, z, self.y_axis))


class Factors(NamedTuple):
    """Numbers of the settings that rules use, and the brightest value of an image."""

    alpha: np.float32
    beta: np.float32
    floor: np.float32
    gain: np.float32
    maximum: np.float32


@dataclass(frozen=True, eq=False)
class Pixels:
    """The pixels of one frame that enter the volume, m of them, row by row.

    Parameters
    ----------
    values : (m,) float32 array
    voxels : (m,) int64 array
        Where each enters, flat [k, j, i]; several may enter one voxel.
    beams : Beams
        Without components where nobody needs them.
    probability, directions : (voxels,) and (voxels, 3) float32 arrays
        The bone map on all voxels; empty but for methods that read it everywhere.
    bone_at : callable, or None
        Probability (n,) and direction (n, 3) of bone at voxels (n,); None without a bone map.
    reach, onset : (m,) float32 arrays
        What the frame itself shows of shadows; empty but for methods that judge them.
    """

    values: Singles
    voxels: Integers
    factors: Factors
    beams: Beams
    probability: Singles
    directions: Singles
    bone_at: Callable[[Integers], tuple[Singles, Singles]] | None
    reach: Singles
    onset: Singles


class Accumulator(Protocol):
    """What is kept of every voxel, as rules see it: `VoxelState` has more."""

    value: Numbers

    @property
    def weights(self) -> Reals:
        """(voxels,), of methods that keep some."""


class AccumulatorTypes(NamedTuple):
    """Types of what is kept of a voxel, and the value before the first pixel; `weight` is None where none is kept."""

    value: type[np.generic]
    weight: type[np.generic] | None = None
    start: float = 0.0


@dataclass(frozen=True, eq=False, kw_only=True)
class CompoundingMethod:
    """What the library asks of a method, whoever wrote it.

    Parameters
    ----------
    words : str
        What it does, for people, in a few words that follow its name.
    kept : callable
        `AccumulatorTypes` by whether pixels are whole numbers of 8 bits, and whether they spread over voxels or count unequally.
    spread : callable, or None
        The rule for pixels that spread over several voxels, or count unequally: brings values (n,) with their shares (n,) into voxels
        (n,). None where the method cannot; of the others linear interpolation can be asked, and they are Plus's too.
    least_share : float
        Of a pixel, below which a voxel gets nothing of it where it spreads.
    weighs_pixels : bool
        Whether an importance mask may weigh them.
    needs_shadows : bool
        Whether it looks at what a frame itself tells of bone.
    works_in_parts : bool
        Whether a grid that does not fit into memory can be reconstructed part by part.
    is_mean : bool
        Values are sums, to be divided by the weights, or by the hits where there are none.
    finish : callable, or None
        What values (n,) become then, before they are rounded. With one, numpy finishes them.
    always_weighs : bool
        Weights are above 0 wherever a pixel entered: hits need not be counted to know where.
    widens : bool
        Its sums go on in float64 once a voxel could have got many pixels.
    follows_agreement : bool
        How far CT and sweep agree decides how wide its bone map is, where nothing else is asked for.
    mends_motion : bool
        The motion of the patient is taken out of the poses, where nothing else is asked for.
    compared : bool
        Whether comparisons in pictures, and the study's tables of wrong CTs and poses, show it, where all would be too many.
    in_plus : str
        Plus's word for it, its CompoundingMode.
    uses : frozenset of str
        Settings that only some methods obey, by name.
    """

    name: str
    words: str
    kept: Callable[[bool, bool], AccumulatorTypes]
    spread: Callable[[Accumulator, Integers, Singles, Reals], None] | None = None
    least_share: float = 0.0
    weighs_pixels: bool = False
    reads_bone: Reading = "nowhere"
    needs_shadows: bool = False
    works_in_parts: bool = True
    is_mean: bool = False
    finish: Callable[[Numbers], Numbers] | None = None
    always_weighs: bool = False
    widens: bool = False
    follows_agreement: bool = False
    mends_motion: bool = False
    compared: bool = False
    in_plus: str = ""
    uses: frozenset[str] = frozenset()

    @property
    def needs_bone(self) -> bool:
        """Whether it looks at a bone map."""
        return self.reads_bone != "nowhere"


@dataclass(frozen=True, eq=False, kw_only=True)
class BuiltInMethod(CompoundingMethod):
    """A method of the library.

    Parameters
    ----------
    insert : callable
        The rule in numpy: brings the `Pixels` of a frame into what is kept. Hits and the best cosine are counted elsewhere.
    """

    insert: Callable[[Accumulator, Pixels], None]
