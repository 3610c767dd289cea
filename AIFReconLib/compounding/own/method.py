"""A method of one's own: one function that says what each pixel of a frame weighs, and how it comes into the table of methods."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib import import_module

import numpy as np
from numpy.typing import ArrayLike

from ...arrays import Reals, Singles
from ...errors import MethodError
from ...message import listed
from ..methods.method import AccumulatorTypes, CompoundingMethod
from ..methods.table import enter, is_own_method, method_named, registered_methods

Answer = tuple[ArrayLike, ArrayLike]
"""Weight and value of every pixel: arrays as large as those that were given, or one number for all."""

OF_BONE = ("cosine", "probability")
"""Arrays that need a bone map, and the direction of the beams."""

OF_SHADOWS = ("reach", "onset")
"""Arrays that need the direction of the beams."""

ARRAYS = ("intensity", *OF_BONE, *OF_SHADOWS)
"""What a method may ask for."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Method(CompoundingMethod):
    """A method of one's own, as `register_method` makes it. It can still be called like the function.

    Its `name`, ``module:function``, is what settings, command line and the header of a volume call it.

    Parameters
    ----------
    arrays : tuple of str
        Which of `ARRAYS` it takes.
    """

    function: Callable[..., Answer]
    arrays: tuple[str, ...]

    def __call__(self, *arguments: object, **named: object) -> Answer:
        return self.function(*arguments, **named)

    def __reduce__(self) -> tuple[Callable[[str], CompoundingMethod], tuple[str]]:
        # By its name, as functions are; the function's own name leads to this
        return load_method, (self.name,)

    def weigh(self, arrays: Mapping[str, Singles], frame: int) -> tuple[Singles, Singles]:
        """Weight and value of each pixel of a frame, (rows, columns) float32, not looked at yet: see `check`.

        Parameters
        ----------
        arrays : mapping of str to (rows, columns) float32 array
            Those that it takes.
        frame : int
            The frame's number, for errors.

        Raises
        ------
        MethodError
            When the function fails, or answers something else than two such arrays.
        """
        shape = next(iter(arrays.values())).shape
        try:
            # Where nothing enters it may divide by zero; where a pixel does, its answer is checked
            with np.errstate(all="ignore"):
                answer = self.function(**arrays)
        except Exception as error:  # whatever the function does, the user is told which one it was
            cause = next(iter(str(error).splitlines()), "")
            raise MethodError(
                f"Method {self.name} failed in frame {frame} ({type(error).__name__}: {cause}). Correct the function."
            ) from error
        try:
            with np.errstate(all="ignore"):
                weight, value = (np.broadcast_to(np.asarray(part).astype(np.float32), shape) for part in answer)
        except (TypeError, ValueError):
            raise MethodError(
                f"Method {self.name} must return a tuple of weight and value, each {shape} numbers like the arrays that it takes, or one "
                f"for all; got {type(answer).__name__}. Return both, the intensity as the value if it stays."
            ) from None
        return weight, value

    def check(self, weight: Reals, value: Reals, frame: int) -> None:
        """Raise `MethodError` unless what pixels of a frame answered, (n,) each, can be added up."""
        # What is NaN compares as false
        if not (weight.min() >= 0 and weight.max() < np.inf):
            wrong = ~((weight >= 0) & (weight < np.inf))
            raise MethodError(
                f"Method {self.name} must return weights that are finite and at least 0; got {weight[wrong][0]} for "
                f"{np.count_nonzero(wrong)} of the {weight.size} pixels of frame {frame} that enter."
            )
        wrong = ~np.isfinite(value)
        if wrong.any() and (wrong := wrong & (weight > 0)).any():
            raise MethodError(
                f"Method {self.name} must return finite values where the weight is above 0; got {value[wrong][0]} for "
                f"{np.count_nonzero(wrong)} of the {weight.size} pixels of frame {frame} that enter."
            )


def register_method(function: Callable[..., Answer]) -> Method:
    """Make a method of reconstruction of a function; written above it as a decorator.

    Parameters
    ----------
    function : callable
        Its arguments say by their names which arrays it takes, each (rows, columns) float32, the part of the image in which pixels count:

        ``intensity``
            Gray levels as recorded; 0 where they are not finite.
        ``cosine``
            Of the angle between the beam and the direction of bone, 0 to 1. Needs a bone map; 0 where there is no bone near.
        ``probability``
            Of bone, 0 to 1. Needs a bone map.
        ``reach``
            How surely sound reached the pixel, 0.01 to 1.01, by the shadows of the frame itself.
        ``onset``
            How surely a shadow begins there, 0 to 1. Of a method that needs a bone map, the map chooses where several places of a scan line
            compete; of another, the frame alone.

        Other arguments must have a default. It returns weight and value of every pixel, as arrays like those or as one number for all.
        A voxel becomes the sum of weight times value over the sum of weights; a pixel of weight 0 does not enter.

    Returns
    -------
    Method
        Its `name`, ``module:function``, is what the settings' `method` is to be. Registered again, it takes the place of the earlier one.

    Raises
    ------
    MethodError
        When it has no name, or an argument that no frame can give.

    Notes
    -----
    What a pixel weighs must not depend on what the function saw before: then the order of frames does not matter, and a volume is the
    same in parts and whole, live and afterwards. Sums are float64. `cosine`, `probability` and the answers are of use within the volume
    alone; `intensity`, `reach` and `onset` are those of the whole frame, wherever the volume ends.

    Examples
    --------
    >>> @register_method
    ... def bright_counts_more(intensity):
    ...     return 1 + intensity, intensity
    >>> bright_counts_more.name.endswith(":bright_counts_more"), bright_counts_more.needs_bone
    (True, False)
    """
    module, word = getattr(function, "__module__", None), getattr(function, "__name__", "")
    name = f"{module}:{word}"
    if not callable(function) or not is_own_method(name):
        raise MethodError(f"Input function must be one with a name of its own; got {function!r}. Write def above it.")
    arrays = []
    for argument in inspect.signature(function).parameters.values():
        by_name = argument.kind in (argument.POSITIONAL_OR_KEYWORD, argument.KEYWORD_ONLY)
        if by_name and argument.name in ARRAYS:
            arrays.append(argument.name)
        elif not by_name or argument.default is argument.empty:
            what = str(argument).partition(":")[0]
            raise MethodError(f"Method {name} takes {what}, which no frame has. Take some of {listed(ARRAYS)}, or give it a default.")
    if not arrays:
        raise MethodError(f"Method {name} must take at least one of {listed(ARRAYS)}.")
    sees_bone, sees_shadows = (not set(arrays).isdisjoint(of) for of in (OF_BONE, OF_SHADOWS))
    method = Method(
        name=name,
        words="a method of one's own",
        kept=lambda whole, shares: AccumulatorTypes(np.float64, np.float64),
        reads_bone="everywhere" if sees_bone else "nowhere",
        works_in_parts=not sees_bone,
        needs_shadows=sees_shadows,
        uses=frozenset({"gray_levels"} if sees_shadows else ()),
        is_mean=True,
        function=function,
        arrays=tuple(arrays),
    )
    enter(method)
    return method


def load_method(name: str) -> CompoundingMethod:
    """The method ``module:function``, its module imported if need be. For names that the user gave, never for those of a file.

    Raises MethodError when there is no such module, it cannot be imported, or it registers no such method.
    """
    if not is_own_method(name):
        raise MethodError(f"Input name must be module:function; got {name!r}.")
    if name in registered_methods():
        return method_named(name)
    module, _, word = name.partition(":")
    try:
        import_module(module)
    except (Exception, SystemExit) as error:  # importing runs the user's code, which fails in whatever way it likes
        raise _why_not_imported(name, module, error) from error
    if name not in registered_methods():
        registered = [known for known in registered_methods() if known.startswith(f"{module}:")]
        has = f"It registers {listed(registered)}." if registered else "It registers no method."
        raise MethodError(f"There is no method {word} in {module}. {has} Write @register_method above def {word}.")
    return method_named(name)


def _why_not_imported(name: str, module: str, error: BaseException) -> MethodError:
    if isinstance(error, ModuleNotFoundError) and error.name is not None and f"{module}.".startswith(f"{error.name}."):
        file = f"{error.name.replace('.', '/')}.py"
        return MethodError(
            f"Method {name} is not found: there is no module {error.name} here. Start where {file} is, or put its folder into PYTHONPATH."
        )
    cause = next(iter(str(error).splitlines()), "")
    return MethodError(f"Method {name} cannot be had: importing {module} fails ({type(error).__name__}: {cause}). Correct the module.")
