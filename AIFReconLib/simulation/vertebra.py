"""One lumbar vertebra in its place, and its shape as a signed distance function: smooth bars from point to point, as its sizes say.

Vertebra frame: see `morphometry`. Right and left are alike but for the tip of the spinous process. Where the bars lie between the places
that the sizes give, and how thick they are, was chosen once for L2 to L5 to lie near the mean shape of 87 patients (`morphometry` [1]_) and
rounded: seen from behind, 0.5 to 0.6 mm from it in the median, 1.1 to 1.6 mm at the 95th percentile.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from ..arrays import Floats, Matrix, Reals, Singles
from ..geometry.transforms import affine, invert
from .implicit_shapes import Bar, Triple, ellipse, smooth_intersection, smooth_union
from .morphometry import BODY_LIFT, LAMINA_THICKNESS, VertebraSizes

DISTANCE_LIMIT = 6.0
"""mm. Signed distances to bone are cut off here: what is farther is far."""

VERTEBRA_BOX = ((-60.0, -50.0, -38.0), (60.0, 74.0, 46.0))
"""mm, corners that contain any vertebra drawn here with 6 mm to spare."""


Joined = tuple[tuple[Bar, float], ...]
"""Bars, each with the fillet, mm, that joins it to those before."""


@dataclass(frozen=True)
class Vertebra:
    """Sizes and place of one vertebra.

    Parameters
    ----------
    label : int
        Its value in the label volume.
    name : str
        "L2" to "L5".
    vertebra_to_reference : (4, 4) float64 array
    spinous_deviation : float
        Sideways shift of the spinous process's tip, mm.
    """

    label: int
    name: str
    vertebra_to_reference: Matrix
    sizes: VertebraSizes
    spinous_deviation: float = 0.0

    @property
    def body_center(self) -> Triple:
        """Middle of the body in the vertebra frame."""
        return 0.0, LAMINA_THICKNESS + self.sizes.canal_depth + self.sizes.body_depth / 2, BODY_LIFT

    @property
    def spinous_tip(self) -> Triple:
        """Middle of the process's hind edge in the vertebra frame."""
        return self.spinous_deviation, -self.sizes.spinous_length, (self.sizes.spinous_top + self.sizes.spinous_bottom) / 2

    def distance(self, x: Reals, y: Reals, z: Reals) -> Reals:
        """Signed distance to bone, mm, cut off at `DISTANCE_LIMIT`, at points of the vertebra frame (float32, of one shape)."""
        shape = x.shape
        x, y, z = (np.ravel(coordinate) for coordinate in (x, y, z))
        side = np.abs(x)
        bone = np.full(len(x), DISTANCE_LIMIT, dtype=np.float32)

        def join(bar: Bar, blend: float, sideways: Reals) -> None:
            near = bar.reaches(sideways, y, z, DISTANCE_LIMIT + blend)
            bone[near] = smooth_union(bone[near], bar.distance(sideways[near], y[near], z[near]), blend)

        for bar, blend in self.arch():
            join(bar, blend, side)
        self.add_body(bone, side, y, z)
        bend = np.float32(self.spinous_deviation / self.sizes.spinous_length)
        for bar, blend in self.spinous_process():
            join(bar, blend, x + bend * np.minimum(y, 0.0))
        return np.minimum(bone, DISTANCE_LIMIT).reshape(shape)

    def add_body(self, bone: Singles, x: Reals, y: Reals, z: Reals) -> None:
        """Join the body, an elliptic drum with a waist, a flattened back wall and slightly hollow endplates, and open the canal."""
        s = self.sizes
        # What rounding takes off
        width, depth = s.body_width + 4.0, s.body_depth + 2.0
        near = np.flatnonzero((y > LAMINA_THICKNESS) & (x < width / 2 + DISTANCE_LIMIT))
        x, y, z = x[near], y[near] - np.float32(LAMINA_THICKNESS + s.canal_depth), z[near] - np.float32(BODY_LIFT)
        radius = 0.58 * depth
        forward = y - np.float32(depth - radius)
        half_height = s.body_height / 2 + forward * np.float32(math.tan(math.radians(s.body_wedge_deg / 2)))
        waist = 1.0 - 0.18 * np.maximum(1.0 - (z / half_height) ** 2, 0.0)
        wall = ellipse(x, forward, width / 2 * waist, radius * waist)
        wall = smooth_intersection(wall, -y - 0.0026 * x * x, 5.0)
        hollow = 1.1 * np.maximum(1.0 - (x / (0.42 * width)) ** 2 - (forward / (0.42 * depth)) ** 2, 0.0)
        body = smooth_intersection(wall, np.abs(z) - half_height + hollow, 3.0)
        # The hind part of the canal is left to the laminae, between which it is a wedge
        canal_radius = s.canal_depth / 2 - 2.5
        canal = ellipse(x, y + np.float32(canal_radius), s.canal_width / 2, canal_radius)
        bone[near] = smooth_intersection(smooth_union(bone[near], body, 3.0), -canal, 2.0)

    def arch(self) -> Joined:
        """Pedicle, lamina, articular and transverse processes of one side."""
        s = self.sizes
        pedicle, thick = (s.canal_width + s.pedicle_width) / 2, s.pedicle_width - 9.0
        superior, inferior, depth = s.superior_width / 2, s.inferior_width / 2, s.facet_depth
        angle = math.radians(s.facet_angle_deg)
        across, along = 2.9 * math.sin(angle), -2.9 * math.cos(angle)
        return (
            # Pedicle
            (
                Bar(
                    (pedicle + 1.5, LAMINA_THICKNESS + s.canal_depth + 5.0, 10.5),
                    (pedicle - 3.0, 19.0, 13.5),
                    (s.pedicle_height / 2, s.pedicle_width / 2 - 0.8),
                    (s.pedicle_height / 2 + 1.5, s.pedicle_width / 2),
                    (0.9, -0.2, -0.4),
                ),
                4.0,
            ),
            # Lamina
            (Bar((5.0, 3.5, 3.5), (inferior - 5.0, depth + 2.0, -5.5), (10.5, 2.2), (8.0, 4.0), (0.7, -0.6, 0.3)), 4.0),
            # Isthmus, between the articular processes
            (
                Bar(
                    (superior - 5.0, depth + 8.0, s.superior_height / 2 + 8.0),
                    (inferior - 2.0, depth + 6.0, 1.5),
                    (6.4, 2.6),
                    (5.5, 4.2),
                    (-0.2, -0.7, 0.0),
                ),
                4.0,
            ),
            # Inferior articular process
            (
                Bar(
                    (inferior - 0.5, depth + 2.0, s.inferior_height / 2 - 0.5),
                    (inferior, depth + 2.0, s.inferior_height),
                    (6.8, 3.8),
                    (6.4, 3.7),
                    (math.cos(angle + 0.37), math.sin(angle + 0.37), 0.0),
                ),
                3.0,
            ),
            # Superior articular process, and the mammillary process behind it
            (
                Bar(
                    (superior - 1.5 - across, depth + 3.3 - along, s.superior_height + 2.6),
                    (superior - 1.5 + across, depth + 3.3 + along, s.superior_height - 1.9),
                    (6.3, 2.2),
                    (8.2, 3.0),
                    (math.cos(angle), math.sin(angle), 0.1),
                ),
                3.0,
            ),
            (
                Bar(
                    (superior + 3.5, depth + 7.0, s.superior_height / 2 + 1.5),
                    (superior + 0.5, depth + 2.0, s.superior_height / 2 + 11.0),
                    (5.1, 2.9),
                    (5.7, 2.2),
                    (0.9, 0.3, -0.1),
                ),
                3.0,
            ),
            # Transverse process
            (
                Bar(
                    (pedicle + 0.5, 12.5 + thick, 10.0 + (s.transverse_height - 12.0) / 2),
                    (s.transverse_width / 2 - 2.5, s.transverse_depth + 1.0, s.transverse_height + 0.3),
                    (6.0 + thick / 8, 5.3 + thick / 8),
                    (4.9, 2.2),
                    (0.3, 0.9, 0.1),
                ),
                4.0,
            ),
        )

    def spinous_process(self) -> Joined:
        """A thin plate that slopes down, and its thicker lower edge."""
        s = self.sizes
        middle, half_height = (s.spinous_top + s.spinous_bottom) / 2, (s.spinous_top - s.spinous_bottom) / 2 + 0.7
        sideways = (1.0, 0.0, 0.0)
        plate = Bar((0.0, 1.0, 6.0), (0.0, half_height - s.spinous_length, middle + 0.5), (6.0, 1.8), (half_height, 2.9), sideways)
        edge = Bar(
            (0.0, -0.12 * s.spinous_length, -2.0),
            (0.0, -0.67 * s.spinous_length, s.spinous_bottom + 4.0),
            (5.9, 4.6),
            (6.0, 2.8),
            sideways,
        )
        return (plate, 4.0), (edge, 3.0)


def flexed(vertebrae: tuple[Vertebra, ...], angle_deg: float) -> tuple[Vertebra, ...]:
    """The vertebrae bent forward (backward where negative) by an angle in degrees at every disc, the middle one staying in its place.

    Notes
    -----
    Each vertebra turns against the next lower one about an axis to the side through the hind part of the lower one's upper endplate, a
    sixth of the body's depth behind its middle: about where lumbar vertebrae turn in flexion and extension [1]_.

    References
    ----------
    .. [1] Pearcy MJ, Bogduk N (1988), Instantaneous axes of rotation of the lumbar intervertebral joints, Spine 13:1033-1041.
    """
    # Superior turns forward: about the patient's right-left axis, z toward y
    turn = affine(turned_about(0, -math.radians(angle_deg)))
    motions = [np.eye(4)]
    for lower in vertebrae[:0:-1]:
        x, y, z = lower.body_center
        pivot = np.eye(4)
        pivot[:3, 3] = x, y - lower.sizes.body_depth / 6, z + lower.sizes.body_height / 2
        about = lower.vertebra_to_reference @ pivot
        about[:3, :3] = np.eye(3)
        motions.append(motions[-1] @ about @ turn @ invert(about))
    motions = motions[::-1]
    still = invert(motions[len(motions) // 2])
    return tuple(replace(v, vertebra_to_reference=still @ motion @ v.vertebra_to_reference) for v, motion in zip(vertebrae, motions))


def turned_about(axis: int, angle: float) -> Floats:
    """Right-handed rotation (3, 3) by an angle in radians about a coordinate axis."""
    a, b = (axis + 1) % 3, (axis + 2) % 3
    matrix = np.eye(3)
    matrix[a, a] = matrix[b, b] = math.cos(angle)
    matrix[a, b], matrix[b, a] = -math.sin(angle), math.sin(angle)
    return matrix
