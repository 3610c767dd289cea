"""What is shown of guidance, as plain values: they cross to a program that has nothing of the library loaded but this."""

from __future__ import annotations

import itertools
from dataclasses import dataclass, field, replace

from ..arrays import Bytes, Floats, Integers, Matrix

_numbers = itertools.count(1)


@dataclass(frozen=True, eq=False)
class BoneMesh:
    """Triangles on the surface of bone."""

    points_reference: Floats  #: (n, 3), mm
    triangles: Integers  #: (m, 3). Numbers of the corners, counter-clockwise seen from outside.
    number: int = field(default_factory=lambda: next(_numbers), init=False)  #: Tells one mesh of a process from another


@dataclass(frozen=True)
class Share:
    """How much of one part of the bone was met; shares are of the reachable area, and NaN where nothing is reachable."""

    reachable_cm2: float  #: Area that some beam from the back could reach
    met: float  #: 0 to 1. Met by a lit frame past all other bone, within 85 degrees.
    below_60_deg: float
    below_45_deg: float
    """0 to 1. Met with a best angle of incidence below this."""
    expected_visibility: float  #: 0 to 1. Share that `weighted` is expected to show; see `CoverageAccumulator.expected`.

    def to_dict(self) -> dict[str, float | None]:
        """All numbers by name, rounded to what they can mean; None where a share is of nothing."""
        return {name: None if value != value else round(float(value), 4) for name, value in vars(self).items()}


@dataclass(frozen=True)
class Direction:
    """One step: an arrow for the eye, and words."""

    arrow: str
    words: str


@dataclass(frozen=True, eq=False)
class ProbeShape:
    """A probe on its image, to be drawn: points and what joins them."""

    points_image: Floats  #: (n, 3), px
    polygons: tuple[tuple[int, ...], ...]  #: Numbers of their corners: of the image plane, and of the body behind its face
    border: tuple[int, ...]  #: Around the image plane


@dataclass(frozen=True, eq=False)
class AdvisedMove:
    """Where the probe should go, and how it gets there."""

    image_to_reference: Matrix  #: (4, 4)
    directions: tuple[Direction, ...]  #: One at least
    over: tuple[int, ...]  #: The label, or the two labels, that the probe will stand over
    adds_cm2: float | None  #: Area of bone that it is expected to show; None where it leads to places that were not seen
    probe: ProbeShape


@dataclass(frozen=True, eq=False)
class GuidanceSnapshot:
    """What is known at one moment; see `Guidance.seen`."""

    problem: str | None = None  #: Why nothing can be told
    surface: int | None = None  #: The number of the mesh that the levels are of; None: no surface is known
    mesh: BoneMesh | None = None  #: In the labels' own coordinates; None where who asked has it
    levels: Bytes | None = None  #: (n,). Of the corners of the mesh; see `AIFReconLib.guidance.mesh`.
    all: Share | None = None  #: Of a CT what faces the back, as by label; None: nothing was met yet
    interspinous: Share | None = None
    by_label: dict[str, Share] = field(default_factory=dict)  #: Of what faces the back, by the name of the label, or its number
    patient_to_reference: Matrix | None = None  #: (4, 4); see `GuidedBone`. None as `all`.
    is_advised: bool = False  #: Whether candidate passes were looked at
    move: AdvisedMove | None = None  #: None with `is_advised`: no further move would add much

    def after(self, before: GuidanceSnapshot | None) -> GuidanceSnapshot:
        """The same with the mesh of the one before, where that was not sent again."""
        if self.mesh is not None or before is None or before.surface != self.surface:
            return self
        return replace(self, mesh=before.mesh)
