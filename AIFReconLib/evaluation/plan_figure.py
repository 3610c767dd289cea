"""The picture of a plan: where the probe goes, and how squarely that meets the bone."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Floats
from .figures import BACKGROUND, new_figure, own_looks, save_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes

LEVELS_DEG = (45.0, 60.0, 70.0, 85.0)
"""Where the colors change: squarely met, obliquely, steeply, grazed."""

COLORS = ("#fde725", "#5ec962", "#21918c", "#4b6bff", "#73767d")
"""Of viridis, which every eye tells apart, from squarely met on; grazed a blue that is far from the last, the gray of what was not met."""

WORDS = ("hit below 45 degrees", "45 to 60", "60 to 70", "grazed", "not hit")
BEAM = "#ff8c42"

SAME_PLACE, NUMBER_AWAY, NUMBER_APART = 6.0, 4.0, 6.0
"""mm: faces as near as this have their numbers one after the other, so far apart; and how far from its pass a number stands."""

STANDS = 0.2
"""mm in the picture from one frame to the next below which a pass leads into it."""

VIEWS = (("from behind", 0, 2), ("from the right", 1, 2))
"""Name, and the axes to the right and up: x to the patient's right, y to the front, z to the head."""


@own_looks()
def plan_figure(
    path: str | Path,
    points_patient: Floats,
    best_cosine: Floats,
    faces_patient: Floats,
    beams: Floats,
    frames: Sequence[int],
    title: str,
) -> None:
    """Draw the bone's points by the best angle at which they are met, and the middle of the probe's face with its middle beam.

    Passes are numbered in the order of scanning, where each begins.

    Parameters
    ----------
    points_patient : (n, 3) array, mm
    best_cosine : (n,) array
        NaN where not met.
    faces_patient, beams : (frames, 3) arrays
        mm, and which way the images' rows run, of any length.
    frames : sequence of int
        Of each pass; together all.
    """
    figure = new_figure(12.0, 6.4, layout="constrained")
    angles = np.degrees(np.arccos(np.clip(np.nan_to_num(best_cosine, nan=-1.0), -1.0, 1.0)))
    kinds = np.digitize(angles, LEVELS_DEG)
    begins = np.cumsum([0, *frames])[:-1]
    ways = beams / np.linalg.norm(beams, axis=1)[:, None]
    ends = faces_patient + 12.0 * ways
    for ax, (name, across, up) in zip(figure.subplots(1, 2), VIEWS, strict=True):
        depth = 1 if across == 0 else 0
        # What lies nearest to the viewer is drawn last
        order = np.argsort(points_patient[:, depth] * (1 if depth == 0 else -1))
        order = order[np.argsort(kinds[order] < len(COLORS) - 1, kind="stable")] if depth == 0 else order
        ax.scatter(*points_patient[order][:, [across, up]].T, c=np.array(COLORS)[kinds[order]], s=7.0, linewidths=0)
        ax.plot(*np.stack([faces_patient, ends])[:, :, [across, up]].transpose(2, 0, 1), color=BEAM, linewidth=0.7, alpha=0.6)
        ax.plot(*faces_patient[:, [across, up]].T, ".", color=BEAM, markersize=3)
        # Before the way that the probe takes; where that leads into the picture, behind the probe
        back = faces_patient[begins] - faces_patient[np.minimum(begins + 1, len(faces_patient) - 1)]
        back = np.where(np.linalg.norm(back[:, [across, up]], axis=1)[:, None] > STANDS, back, -ways[begins])
        _number(ax, faces_patient[begins][:, [across, up]], back[:, [across, up]])
        ax.set(aspect="equal", xlabel="to the right, mm" if across == 0 else "to the front, mm", ylabel="to the head, mm")
        ax.set_title(name, fontsize=11)
        ax.spines[:].set_visible(False)
    handles = [ax.scatter([], [], color=color, s=30) for color in COLORS] + [ax.plot([], [], color=BEAM)[0]]
    figure.legend(handles, [*WORDS, "probe"], loc="outside lower center", ncols=len(handles), fontsize=10)
    figure.suptitle(title, fontsize=13)
    save_figure(path, figure)


def _number(ax: Axes, faces: Floats, back: Floats) -> None:
    """The passes' numbers beside the faces, (n, 2) mm, `back` from the probe's way; of faces in one place one after the other."""
    taken: dict[tuple[int, ...], int] = {}
    for number, (face, way) in enumerate(zip(faces, back, strict=True), start=1):
        place = tuple(np.rint(face / SAME_PLACE).astype(int).tolist())
        beside = taken[place] = taken.get(place, -1) + 1
        at = face + (NUMBER_AWAY + NUMBER_APART * beside) * way / max(float(np.linalg.norm(way)), 1e-9)
        box = {"boxstyle": "round,pad=0.15", "facecolor": BACKGROUND, "edgecolor": "none", "alpha": 0.75}
        ax.annotate(str(number), at, color=BEAM, fontsize=9, fontweight="bold", ha="center", va="center", annotation_clip=False, bbox=box)
