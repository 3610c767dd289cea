"""Options of a recipe's settings, made from their declarations, and the recipe that they ask for."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields
from pathlib import Path
from typing import Any

from ..compounding.methods.table import OWN_METHOD, is_own_method
from ..compounding.own.method import load_method
from ..errors import MethodError
from ..recipe.recipe import RULES, Branch, Recipe
from ..recipe.rules import FILE, FLAG, NUMBERS, TEXT, WHOLE, WORDS, Rule
from .one_line_parser import NumbersAction, TakingAction, numbers
from .remedies import in_options


class OwnChoices(tuple[str, ...]):
    """The choices of a setting to which the names of methods of one's own belong."""

    def __contains__(self, name: object) -> bool:
        return super().__contains__(name) or (isinstance(name, str) and is_own_method(name))


class MethodAction(TakingAction):
    """Takes the name of a method. One of the user's own is imported: the module that was named here, and no other."""

    def taken(self, given: str, before: object) -> str:
        """The name."""
        try:
            if is_own_method(given):
                load_method_here(given)
        except MethodError as error:
            raise argparse.ArgumentError(self, in_options(error).rstrip(".")) from None
        return given


def load_method_here(name: str) -> None:
    """Import the module of a method of one's own, from the folder that the program is called in too.

    Raises MethodError when it cannot be had.
    """
    # As `python -m` has it: the installed program knows the packages alone
    if not {"", os.getcwd()} & set(sys.path):
        sys.path.append(os.getcwd())
    load_method(name)


def add_setting(group: argparse._ActionsContainer, name: str, default: object = None, rules: Mapping[str, Rule] = RULES) -> None:
    """Declare the option of a setting, unless it has none or is declared already; `default` where the command has one of its own."""
    rule, option = rules[name], "--" + name.replace("_", "-")
    if not rule["metavar"] or option in group._option_string_actions:
        return
    shown = rule["default"] if default is None else default
    unit = f" [{rule['unit']}]" if rule["unit"] else ""
    told = "" if shown is None or shown is False else f" (default: {shown:g})" if isinstance(shown, float) else f" (default: {shown})"
    words: dict[str, Any] = {"help": rule["help"] + unit + told, "dest": name, "default": default}
    names = rule["metavar"].split()
    if rule["kind"] == FLAG:
        group.add_argument(option, action="store_true" if rule["default"] is False else argparse.BooleanOptionalAction, help=words["help"])
    elif rule["kind"] == WORDS:
        group.add_argument(option, nargs="+", metavar=names[0], **words)
    elif rule["own"]:
        group.add_argument(option, choices=OwnChoices([*(rule["choices"] or ()), OWN_METHOD]), action=MethodAction, **words)
    elif rule["choices"]:
        group.add_argument(option, choices=rule["choices"], **words)
    elif rule["kind"] == NUMBERS and 1 in rule["counts"]:
        group.add_argument(option, action=NumbersAction, type=numbers, metavar=names[0], **words)
    elif rule["kind"] == NUMBERS:
        group.add_argument(option, type=float, nargs=len(names), metavar=tuple(names), **words)
    else:
        number = float if rule["word"] is None else number_or(rule["word"])
        group.add_argument(option, type={WHOLE: int, TEXT: str, FILE: Path}.get(rule["kind"], number), metavar=names[0], **words)


def add_settings(group: argparse._ActionsContainer, *branches: type[Branch], without: Sequence[str] = ()) -> None:
    """Declare the options of all settings of these branches that are not declared yet."""
    for branch in branches:
        for spec in fields(branch):
            if spec.name not in without:
                add_setting(group, spec.name)


def number_or(word: str) -> Callable[[str], float | str]:
    """What reads a number or this word from the command line."""

    def read(text: str) -> float | str:
        try:
            return word if text == word else float(text)
        except ValueError:
            raise argparse.ArgumentTypeError(f"must be {word} or a number such as 0.5, without a unit; got {text!r}") from None

    return read


def add_imaging_options(parser: argparse.ArgumentParser) -> argparse._ArgumentGroup:
    """Probe, clip rectangle and fan; the answer is the group, for more of the kind."""
    image = parser.add_argument_group("image", "what the image shows; default: the configuration's, else recognized by the black surround")
    for name in ("probe", "apex_px", "clip_px", "fan_angles_deg", "fan_radius_px"):
        add_setting(image, name)
    return image


def recipe_from(arguments: argparse.Namespace) -> Recipe:
    """The recipe that the given options ask for; options that were not given keep their defaults."""
    given = {name: value for name in RULES if (value := getattr(arguments, name, None)) is not None}
    return Recipe(**{**given, "best_cosine": bool(getattr(arguments, "cosine", None))})
