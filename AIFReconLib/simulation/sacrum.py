"""The sacrum's top: body, wings, superior articular processes, the plate behind the canal with its crest, and the first foramina.

Its frame is a vertebra's, with z square to the endplate. It ends below, out of the scan, as a CT of the lumbar spine ends.
"""

from __future__ import annotations

import math

import numpy as np

from ..arrays import Reals, Singles
from .implicit_shapes import Bar, ellipse, smooth_intersection, smooth_union
from .morphometry import BODY_LIFT, LAMINA_THICKNESS
from .vertebra import Joined, Vertebra

LOWER_END = -34.0
"""z of the cut, mm."""


class Sacrum(Vertebra):
    """S1 and what follows of S2, as a vertebra of the phantom."""

    def add_body(self, bone: Singles, x: Reals, y: Reals, z: Reals) -> None:
        """Join the body, which tapers downward, cut all at the endplate and below, and open canal and foramina."""
        s = self.sizes
        back, top = LAMINA_THICKNESS + s.canal_depth, BODY_LIFT + s.body_height / 2
        way = np.clip((top - z) / (top - LOWER_END), 0.0, 1.0)
        middle = back + s.body_depth / 2 - (4.0 + s.body_depth / 5) * way
        body = ellipse(x, y - middle, s.body_width / 2 * (1.0 - 0.35 * way), s.body_depth / 2 * (1.0 - 0.4 * way))
        body = smooth_intersection(body, z - np.float32(top), 3.0)
        whole = smooth_union(bone, body, 5.0)
        canal_y = LAMINA_THICKNESS + s.canal_depth / 2 - 3.0 * way
        canal = ellipse(x, y - canal_y, s.canal_width / 2 * (1.0 - 0.4 * way), (s.canal_depth / 2 - 1.0) * (1.0 - 0.3 * way))
        foramen = np.hypot(x - np.float32(s.canal_width / 2 + 5.0), z + 16.0) - 4.0
        opened = smooth_intersection(smooth_intersection(whole, -canal, 2.0), -foramen, 3.0)
        bone[:] = np.maximum(opened, np.float32(LOWER_END) - z)

    def arch(self) -> Joined:
        """Wing, plate behind the canal and superior articular process of one side."""
        s = self.sizes
        angle = math.radians(s.facet_angle_deg)
        superior, wing = s.superior_width / 2, s.transverse_width / 2
        return (
            (
                Bar(
                    (16.0, 32.0, 5.0),
                    (wing - 12.0, s.transverse_depth, s.transverse_height - 6.0),
                    (13.0, 13.0),
                    (12.0, 12.0),
                    (0.0, 1.0, 0.0),
                ),
                5.0,
            ),
            (Bar((wing - 14.0, s.transverse_depth, 0.0), (27.0, 10.0, -36.0), (12.0, 12.0), (9.0, 9.0), (0.0, 1.0, 0.0)), 6.0),
            (Bar((2.0, 2.0, 1.0), (superior, s.facet_depth + 4.0, 2.0), (8.0, 3.0), (10.0, 4.0), (-0.1, -0.9, 0.3)), 4.0),
            (Bar((5.0, 0.0, -8.0), (15.0, 3.0, -38.0), (10.0, 3.5), (12.0, 4.5), (-0.2, -0.9, 0.1)), 5.0),
            (Bar((superior + 3.0, 9.0, -1.0), (24.0, 6.0, -38.0), (7.0, 5.0), (9.0, 6.0), (-0.3, -0.9, 0.0)), 6.0),
            (
                Bar(
                    (superior - 3.0, s.facet_depth + 5.0, s.superior_height - 1.0),
                    (superior + 3.0, s.facet_depth - 1.0, s.superior_height - 3.0),
                    (8.0, 3.0),
                    (8.0, 3.5),
                    (math.cos(angle), math.sin(angle), 0.0),
                ),
                4.0,
            ),
        )

    def spinous_process(self) -> Joined:
        """The tubercle of S1 and the median crest below."""
        s = self.sizes
        tubercle = Bar(
            (0.0, 0.0, 2.0), (0.0, 6.5 - s.spinous_length, (s.spinous_top + s.spinous_bottom) / 2), (5.5, 2.5), (6.5, 3.0), (1.0, 0.0, 0.0)
        )
        crest = Bar((0.0, -3.0, -6.0), (0.0, -3.0, -30.0), (4.5, 3.0), (4.5, 3.0), (1.0, 0.0, 0.0))
        return (tubercle, 4.0), (crest, 5.0)
