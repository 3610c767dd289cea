"""The picture of a plan: where the probe goes, and how squarely that meets the bone."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ..arrays import Floats
from .figures import BACKGROUND, INK, new_figure, own_looks, save_figure

LEVELS_DEG = (45.0, 60.0, 70.0, 85.0)
"""Where the colors change: squarely met, obliquely, steeply, grazed."""

COLORS = ("#fde725", "#5ec962", "#21918c", "#4b6bff", "#73767d")
"""Of viridis, which every eye tells apart, from squarely met on; grazed a blue that is far from the last, the gray of what was not met."""

WORDS = ("hit below 45 degrees", "45 to 60", "60 to 70", "grazed", "not hit")
BEAM = "#ff8c42"

VIEWS = (("from behind", 0, 2), ("from the right", 1, 2))
"""Name, and the axes to the right and up: x to the patient's right, y to the front, z to the head."""


@own_looks()
def plan_figure(path: str | Path, points_patient: Floats, best_cosine: Floats, faces_patient: Floats, beams: Floats, title: str) -> None:
    """Draw the bone's points by the best angle at which they are met, and the middle of the probe's face with its middle beam.

    Parameters
    ----------
    points_patient : (n, 3) array, mm
    best_cosine : (n,) array
        NaN where not met.
    faces_patient, beams : (frames, 3) arrays
        mm, and which way the images' rows run, of any length.
    """
    figure = new_figure(12.0, 6.4, layout="constrained")
    angles = np.degrees(np.arccos(np.clip(np.nan_to_num(best_cosine, nan=-1.0), -1.0, 1.0)))
    kinds = np.digitize(angles, LEVELS_DEG)
    ends = faces_patient + 12.0 * beams / np.linalg.norm(beams, axis=1)[:, None]
    for ax, (name, across, up) in zip(figure.subplots(1, 2), VIEWS, strict=True):
        depth = 1 if across == 0 else 0
        # What lies nearest to the viewer is drawn last
        order = np.argsort(points_patient[:, depth] * (1 if depth == 0 else -1))
        order = order[np.argsort(kinds[order] < len(COLORS) - 1, kind="stable")] if depth == 0 else order
        ax.scatter(*points_patient[order][:, [across, up]].T, c=np.array(COLORS)[kinds[order]], s=7.0, linewidths=0)
        ax.plot(*np.stack([faces_patient, ends])[:, :, [across, up]].transpose(2, 0, 1), color=BEAM, linewidth=0.7, alpha=0.6)
        ax.plot(*faces_patient[:, [across, up]].T, ".", color=BEAM, markersize=3)
        ax.set_aspect("equal")
        ax.set_title(name, color=INK, fontsize=11)
        ax.set_facecolor(BACKGROUND)
        ax.set_xlabel("to the right, mm" if across == 0 else "to the front, mm", color=INK)
        ax.set_ylabel("to the head, mm", color=INK)
        ax.tick_params(colors=INK)
        for side in ax.spines.values():
            side.set_visible(False)
    handles = [ax.scatter([], [], color=color, s=30) for color in COLORS] + [ax.plot([], [], color=BEAM)[0]]
    figure.legend(handles, [*WORDS, "probe"], loc="outside lower center", ncols=len(handles), frameon=False, labelcolor=INK, fontsize=10)
    figure.suptitle(title, color=INK, fontsize=13, parse_math=False)
    save_figure(path, figure)
