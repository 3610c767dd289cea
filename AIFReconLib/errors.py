"""Every error that a user can cause or meet.

Each class is a domain error and a builtin one, so that callers may catch either. An error says in a complete sentence what is wrong and
where, and which settings would mend it; the terminal, Python and the panel each write those in their own way.
"""

from __future__ import annotations

from pathlib import PurePath

from .message import Sentence, advised


class AIFReconError(Exception):
    """Anything that the library reports on purpose. Programming mistakes raise other exceptions.

    Parameters
    ----------
    sentence : str
        What is wrong, and where.
    advice, **details
        As `Sentence` takes them.
    """

    def __init__(self, sentence: str = "", /, advice: str | BaseException = "", **details: object):
        if advice or not isinstance(sentence, Sentence):
            sentence = Sentence(sentence, advice, **details)
        super().__init__(sentence)

    def __reduce__(self) -> tuple[type[AIFReconError], tuple[object, ...], dict[str, object]]:
        """Made anew from its sentence in another process; Dask takes errors apart that do not say how."""
        return type(self), self.args, self.__dict__

    def __str__(self) -> str:
        """The sentence, and what to do for who calls the library from Python; `said` has it alone."""
        return advised(self.args[0])


class SettingsError(AIFReconError, ValueError):
    """A parameter is out of its range, or parameters contradict each other."""


class InputTypeError(AIFReconError, TypeError):
    """Something of another kind was given than what is taken: a path in the place of what the file holds, an array without a place."""


class MethodError(AIFReconError, ValueError):
    """A method of the user's own cannot be found, or answers what cannot be added up."""


class GeometryError(AIFReconError, ValueError):
    """A matrix, grid or probe geometry cannot be used: not finite, singular, sheared, mirrored or of the wrong shape."""


class TransformError(AIFReconError, LookupError):
    """The transforms do not lead from one frame to the other, or lead there in ways that disagree."""


class FileFormatError(AIFReconError, ValueError):
    """A file cannot be understood: cut short, of a wrong size, or of a kind that is not supported; a network cannot be run."""


class SequenceFormatError(FileFormatError):
    """A tracked sequence file cannot be understood."""


class VolumeFormatError(FileFormatError):
    """A volume file cannot be understood."""


class ConfigurationError(FileFormatError):
    """A Plus configuration file cannot be understood."""


class NoUsableFramesError(AIFReconError, ValueError):
    """Not one frame of a sequence has both an image and a valid pose."""


class BeamGeometryError(AIFReconError, ValueError):
    """The direction of the beams is needed and cannot be told."""


class InsufficientMemoryError(AIFReconError, MemoryError):
    """The volume asked for does not fit into memory."""


class RegistrationRefused(AIFReconError):
    """A CT was not placed, or a calibration not found: the bone does not agree, or another answer fits as well. Nothing is written."""


class OutputError(AIFReconError, OSError):
    """A result cannot be written. Nothing is left behind under its name."""


class LiveConnectionError(AIFReconError, ConnectionError):
    """A live stream cannot be opened, or a port cannot be served."""


class LiveMessageError(AIFReconError, ValueError):
    """A message of a live stream arrived whole and still cannot be used."""


class WorkerDiedError(AIFReconError, RuntimeError):
    """The process that computes has ended in the middle: killed, crashed, or out of memory. The next call begins a new one."""


class OperationCanceled(AIFReconError):
    """The caller's progress function asked to stop. Inputs are untouched."""


class DoubtfulInputWarning(UserWarning):
    """A recording contradicts itself, or what is known of probes and patients."""


class DisagreementWarning(UserWarning):
    """A CT and a sweep that are used together do not agree."""


def require_kind(name: str, value: object, kinds: type | tuple[type, ...], advice: str) -> None:
    """Return if `value`, which the caller knows as `name`, is of one of these kinds.

    Raises InputTypeError with `advice`, where it is not.
    """
    if not isinstance(value, kinds):
        raise not_of_kind(name, value, kinds if isinstance(kinds, tuple) else (kinds,), advice)


def not_of_kind(name: str, value: object, kinds: tuple[type, ...], advice: str) -> InputTypeError:
    """The error of a `value` that is of none of these kinds."""
    wanted = " or ".join(kind.__name__ for kind in kinds if kind is not type(None))
    return InputTypeError(f"Input {name} must be {wanted}; got {_in_words(value)}. {advice}")


def _in_words(value: object) -> str:
    """What it is that was given."""
    if isinstance(value, str | PurePath):
        return repr(str(value))
    shape = getattr(value, "shape", None)
    kind = type(value).__name__
    return f"{kind} of shape {shape}" if isinstance(shape, tuple) else kind
