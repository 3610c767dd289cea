"""Every error that a user can cause or meet.

Each class is a domain error and a builtin one, so that callers may catch either. Messages are complete sentences: what is
wrong, where, and what to do about it. The command line prints them as they are, on one line; Slicer looks up a translation of the
sentence before its values were filled in, which every error therefore keeps. So the sentence is spelled out where it is raised, with
its values named: ``raise SettingsError("Input rate must be above 0; got {rate!r}.", rate=rate)``, never an f-string.
"""

from __future__ import annotations

from .message import Message


class AIFReconError(Exception):
    """Anything that the library reports on purpose. Programming mistakes raise other exceptions.

    Parameters
    ----------
    message : str
        The sentence, with its values in braces, as in ``SettingsError("Input rate must be positive; got {rate!r}.", rate=0)``. It is kept
        as a `Message`, which can be translated; a text that was formatted before cannot. Without values it is taken as it is.
    **values
        What the sentence names.
    """

    def __init__(self, message: str = "", /, **values: object):
        super().__init__(message if isinstance(message, Message) and not values else Message(message, **values))


class SettingsError(AIFReconError, ValueError):
    """A parameter is out of its range, or parameters contradict each other."""


class GeometryError(AIFReconError, ValueError):
    """A matrix, grid or probe geometry cannot be used: not finite, singular, sheared, mirrored or of the wrong shape."""


class TransformError(AIFReconError, LookupError):
    """The transforms do not lead from one frame to the other, or lead there in two ways."""


class FileFormatError(AIFReconError, ValueError):
    """A file cannot be understood: cut short, of a wrong size, or of a kind that is not supported."""


class SequenceFormatError(FileFormatError):
    """A tracked sequence file cannot be understood."""


class VolumeFormatError(FileFormatError):
    """A volume file cannot be understood."""


class ConfigurationError(FileFormatError):
    """A Plus configuration file cannot be understood."""


class TransformFileError(FileFormatError):
    """A transform file cannot be understood."""


class SettingsFileError(FileFormatError):
    """A settings file, or what a volume says of how it was made, cannot be understood."""


class NoUsableFramesError(AIFReconError, ValueError):
    """Not one frame of a sequence has both an image and a valid pose."""


class BeamGeometryError(AIFReconError, ValueError):
    """The direction of the beams is needed and cannot be told."""


class InsufficientMemoryError(AIFReconError, MemoryError):
    """The volume asked for does not fit into memory."""


class RegistrationRefused(AIFReconError):
    """A CT was not placed: the bone does not agree, or another place fits as well. No transform is written."""


class OutputError(AIFReconError, OSError):
    """A result cannot be written. Nothing is left behind under its name."""


class LiveConnectionError(AIFReconError, ConnectionError):
    """A live stream cannot be opened, or a port cannot be served."""


class LiveMessageError(AIFReconError, ValueError):
    """A message of a live stream arrived whole and still cannot be used."""


class OperationCanceled(AIFReconError):
    """The caller's progress function asked to stop. Inputs are untouched."""
