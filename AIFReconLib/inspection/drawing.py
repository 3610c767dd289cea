"""Lines and words on a white page: as SVG, or to be painted by a window, both without a package for plots."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from xml.sax.saxutils import escape

from ..arrays import Floats

DOT = 3.0
"""Points. Radius of the end of an axis."""


@dataclass(frozen=True, eq=False)
class Stroke:
    """A line through points (n, 2) of the page; `closed` ends where it begins, `tinted` inside, `dotted` at its end."""

    points: Floats
    color: str  #: #rrggbb
    width: float = 1.0
    closed: bool = False
    tinted: bool = False
    dotted: bool = False


@dataclass(frozen=True)
class Words:
    """A text that begins at a point of the page, on its line."""

    x: float
    y: float
    text: str
    color: str = "#000000"
    size: int = 12


@dataclass(frozen=True, eq=False)
class Drawing:
    """What is drawn, in points from the upper left corner of a white page."""

    width: float
    height: float
    strokes: tuple[Stroke, ...]
    words: tuple[Words, ...]

    @classmethod
    def of(cls, width: float, height: float, drawn: Iterable[Stroke | Words]) -> Drawing:
        """A page of strokes and words, words on top."""
        both = list(drawn)
        strokes = tuple(each for each in both if isinstance(each, Stroke))
        return cls(width, height, strokes, tuple(each for each in both if isinstance(each, Words)))

    def to_svg(self) -> str:
        """The text of an SVG file."""
        page = f'width="{self.width:.0f}" height="{self.height:.0f}"'
        box = f'viewBox="0 0 {self.width:.0f} {self.height:.0f}" font-family="sans-serif"'
        lines = [f'<svg xmlns="http://www.w3.org/2000/svg" {page} {box}>']
        lines += [f'<rect {page} fill="white"/>', *map(_svg_of, self.strokes)]
        lines += [f'<text x="{w.x:.1f}" y="{w.y:.1f}" font-size="{w.size}" fill="{w.color}">{escape(w.text)}</text>' for w in self.words]
        return "\n".join([*lines, "</svg>\n"])


def _svg_of(stroke: Stroke) -> str:
    points = " ".join(f"{x:.1f},{y:.1f}" for x, y in stroke.points)
    fill = f'fill="{stroke.color}" fill-opacity="0.2"' if stroke.tinted else 'fill="none"'
    end = f'<circle cx="{stroke.points[-1, 0]:.1f}" cy="{stroke.points[-1, 1]:.1f}" r="{DOT:g}" fill="{stroke.color}"/>'
    look = f'{fill} stroke="{stroke.color}" stroke-width="{stroke.width:g}"'
    line = f'<poly{"gon" if stroke.closed else "line"} points="{points}" {look}/>'
    return line + (end if stroke.dotted else "")
