"""A calibration from scans, on a CT's bone, on the surface that they show, or on wires: found, told, drawn and written in one way."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np

from .. import __version__
from ..arrays import Floats, Matrix
from ..calibration.calibration import as_report, calibrate, findings
from ..calibration.crossing import calibrate_by_crossing, crossing_findings, crossing_report
from ..calibration.mending import Mending
from ..calibration.nwire import PHANTOM, WireCalibration, calibrate_on_wires, wire_findings, wire_report
from ..errors import RegistrationRefused, SettingsError
from ..evaluation.registration_figure import calibration_figure, wire_figure
from ..geometry.transform_graph import TransformName
from ..geometry.volume import Volume
from ..io.plus.calibration import write_calibrated
from ..io.plus.configuration import read_plus_configuration
from ..io.plus.phantom import read_wire_phantom
from ..io.transform.files import write_transform
from ..message import message_of
from ..progress import Progress
from ..recipe.recipe import Recipe
from ..sweep.frames import TrackedSequence
from ..sweep.multi_sweep import JoinedImages
from ..sweep.poses import chain_ends


@dataclass(frozen=True, eq=False)
class _CalibrationOutput:
    """A calibration, and what is to be said of it."""

    sequences: list[TrackedSequence]
    found: Mending | WireCalibration
    lines: list[str]
    facts: dict[str, object]  #: For JSON
    draw: Callable[[Path], None]  #: Draws it into a file
    name: TransformName | None = None  #: Of the transform that it replaces in a configuration

    @property
    def report(self) -> dict[str, object]:
        """All of it, for JSON."""
        return {"sequences": [sequence.name for sequence in self.sequences], "version": __version__, **self.facts}

    def require_accepted(self) -> None:
        """Return if it may be used; RegistrationRefused says why not."""
        if self.found.reason is not None:
            raise RegistrationRefused(f"No calibration is written. {self.found.reason}", message_of(self.found.reason))

    def write(self, path: Path, configurations: Sequence[Path]) -> None:
        """Write the first configuration with it in the place of its own; without a name, a correction of the image."""
        found = self.found
        if isinstance(found, WireCalibration):
            name, matrix = found.name, found.image_to_probe
        elif self.name is None:
            write_transform(found.image_correction, path)
            return
        else:
            name, matrix = self.name, found.mended(np.asarray(self.sequences[0].configured()[self.name].matrix))
        note = f"aifrecon {__version__}, by {', '.join(sequence.name for sequence in self.sequences)}"
        write_calibrated(configurations[0], path, name, matrix, note)


def calibration_of(
    sequences: list[TrackedSequence],
    labels: Volume | None,
    start: Matrix | None,
    recipe: Recipe,
    replaces: bool,
    progress: Progress | None = None,
) -> _CalibrationOutput:
    """A calibration on the bone of a CT, else on the surface that the sweeps' own echoes show.

    Raises SettingsError where it `replaces` one in a configuration, and none is there.
    """
    name = _configured(sequences[0], recipe) if replaces else None
    rough = sequences[0].configuration.rough
    if rough and labels is not None:
        raise SettingsError(f"{rough[0]} was measured by hand. Calibrate without the CT first, then from what that writes with it.")
    if labels is None:
        found = calibrate_by_crossing(sequences, rough=bool(rough), recipe=recipe, progress=progress)
        titles = f"before: {found.before:.2f} mm between angles", f"after: {found.after:.2f} mm"
        draw = partial(_draw, found, found.placed_echoes, titles, None)
        return _CalibrationOutput(sequences, found, crossing_findings(found), crossing_report(found), draw, name)
    laid = calibrate(sequences, labels, start, recipe=recipe, progress=progress)
    titles = f"before: {laid.before.sentence()}", f"after: {laid.after.sentence()}"
    draw = partial(_draw, laid, laid.echoes_on_bone, titles, labels)
    return _CalibrationOutput(sequences, laid, findings(laid), as_report(laid), draw, name)


def calibration_on_wires(
    sequences: list[TrackedSequence], phantom: Path, image_to_probe: str | None = None, progress: Progress | None = None
) -> _CalibrationOutput:
    """A calibration on the N-wires that a configuration describes, placed as the recordings say, else as it says itself."""
    wires = read_wire_phantom(phantom)
    place = {name: sample for name, sample in read_plus_configuration(phantom).transforms.items() if _is_of_phantom(name)}
    placed = []
    for sequence in sequences:
        known = sequence.configuration.transforms
        more = {} if any(map(_is_of_phantom, known)) else place
        placed.append(replace(sequence, configuration=replace(sequence.configuration, transforms={**known, **more})))
    found = calibrate_on_wires(placed, wires, name=image_to_probe, progress=progress)
    return _CalibrationOutput(placed, found, wire_findings(found), wire_report(found, wires), partial(_draw_wires, found, placed))


def _is_of_phantom(name: TransformName) -> bool:
    return PHANTOM in (name.source, name.target)


def _configured(sequence: TrackedSequence, recipe: Recipe) -> TransformName:
    """The transform of the configuration that is to be replaced."""
    wanted, _ = chain_ends(sequence.configuration, recipe.image_to_reference, None)
    names = [name for name in sequence.configured() if name.source == wanted.source]
    if len(names) != 1:
        raise SettingsError(
            f"{sequence.name}: the calibration is not in the configuration but in the recording.",
            "Write a .tfm and give it to {convert} {correction}.",
        )
    return names[0]


def _draw(found: Mending, placed: tuple[Floats, Floats], titles: tuple[str, str], labels: Volume | None, path: Path) -> None:
    calibration_figure(path, placed, found.echoes.angles[found.echoes.frames], titles, labels)


def _draw_wires(found: WireCalibration, sequences: list[TrackedSequence], path: Path) -> None:
    shown = found.frames[np.linspace(0, len(found.frames.numbers) - 1, 3).round().astype(int)]
    stack = JoinedImages([sequence.images for sequence in sequences])
    images = [stack[int(number)] for number in shown.numbers]
    points, expected = (one.reshape(len(images), -1, 2) for one in (shown.points, shown.expected(found.image_to_probe)))
    wire_figure(path, images, points, expected, wire_findings(found)[1])
