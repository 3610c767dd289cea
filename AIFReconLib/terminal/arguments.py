"""The arguments of a command: fields of a class, explained in its docstring, become argparse's; what is wrong with them is one line."""

from __future__ import annotations

import argparse
import difflib
import inspect
import itertools
import os
import shutil
import sys
import textwrap
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from types import NoneType
from typing import Annotated, Any, ClassVar, NewType, TypeAlias, TypeVar, get_args, get_origin, get_type_hints

from ..compounding.methods.table import OWN_METHOD, is_own_method
from ..compounding.own.method import load_method
from ..errors import MethodError, SettingsError
from ..recipe.recipe import AUTOMATIC, RULES, Branch, Recipe
from ..recipe.rules import FILE, FLAG, NUMBERS, TEXT, WHOLE, WORDS, Rule, checked, explained
from .refusing import RefusingParser, WrongArguments
from .remedies import in_options

Output = NewType("Output", Path)
"""A file that is written."""

Names: TypeAlias = tuple[str, ...]
Rivals: TypeAlias = tuple[Names, ...]
Spellings: TypeAlias = Mapping[str, Names]
Settings: TypeAlias = tuple[str | type[Branch], ...]

JOIN = "\0"
"""Between words that became one: no word of a command line holds it."""


class Options:
    """messages: of every command

    A command's class and the groups of options that it inherits from say the rest. A group's summary is its title and what it is about.

    Attributes
    ----------
    WORDS : tuple of str
        Fields that are given without their names.
    SETTINGS : tuple of str or branches of a recipe
        Settings whose options belong to the class, too: as `RULES` declares them.
    RIVALS : tuple of tuples of str
        Fields of which one may be given, and must be where one of them has no default.
    SPELLED : mapping of str to tuple of str
        Fields that are spelled in another way.
    FIRST : tuple of str
        Fields that a short help shows beside what must be given; all where there are none.
    NOTES : str
        What a help says behind the examples, which are those of the docstring.

    Parameters
    ----------
    help
        show this help, of all options with --help-all
    help_all
        show every option
    quiet
        print nothing but errors
    verbose
        tell what happens, on standard error
    log : FILE
        append what happens to this file, with the details of errors

    Notes
    -----
    What an option takes is told by its annotation: ``Path``, ``float``, ``int``, ``str``: one; ``tuple[float, float]``: so many;
    ``tuple[Path, ...]``: one or more; ``list[Path]``: one, as often as wanted; ``bool``: none; ``Annotated[int, (1, 2)]``: one of these;
    ``Annotated[int, gigabytes]``: what a function reads; a second function: which of the words that follow belong to it.
    An option that was not given has the default of its class, and is no attribute of the instance; a setting is None.
    """

    help: bool = False
    help_all: bool = False
    quiet: bool = False
    verbose: bool = False
    log: Path | None = None

    WORDS: ClassVar[Names] = ()
    SETTINGS: ClassVar[Settings] = ()
    RIVALS: ClassVar[Rivals] = (("quiet", "verbose"),)
    SPELLED: ClassVar[Spellings] = {
        "help": ("-h", "--help"),
        "quiet": ("-q", "--quiet"),
        "output": ("-o", "--output"),
    }
    FIRST: ClassVar[Names] = ()
    NOTES: ClassVar[str] = ""
    RULES: ClassVar[Mapping[str, Rule]] = RULES

    def __getattr__(self, name: str) -> Any:
        if name in RULES or name in type(self).RULES:
            return None
        raise AttributeError(name)

    @property
    def recipe(self) -> Recipe:
        """The recipe that is asked for; settings that were not given keep their defaults."""
        given = {name: value for name in RULES if (value := getattr(self, name)) is not None}
        if given.get("time_offset") == AUTOMATIC:  # still to be found
            del given["time_offset"]
        return Recipe(**{**given, "best_cosine": bool(getattr(self, "cosine", None))})

    def complete(self) -> None:
        """Take what follows from what was given."""


Asked = TypeVar("Asked", bound=Options)


def with_values(asked: Asked, **values: object) -> Asked:
    """The same with other values of these fields."""
    other = type(asked)()
    vars(other).update({**vars(asked), **values})
    return other


def given_words(asked: Options, *groups: type[Options]) -> list[str]:
    """Those options of groups that were given, as one would type them."""
    words = []
    for name in (each.name for group in groups for each in declared(group) if each.group is not Options):
        value = vars(asked).get(name)
        for each in value if isinstance(value, list) else [] if value is None else [value]:
            several = each if isinstance(each, tuple) else [each]
            typed = [f"{one:g}" if isinstance(one, float) else str(one) for one in several]
            words += [spelling(type(asked), name)[0], *(["=".join(typed)] if name == "transform_sequence" else typed)]
    return words


# ---- words


Read = TypeVar("Read")


def reading(read: Callable[[str], Read], words: str) -> Callable[[str], Read]:
    """What reads a word of the command line and, where it cannot, says what the word must be."""

    def read_word(text: str) -> Read:
        try:
            return read(text)
        except ValueError:
            raise argparse.ArgumentTypeError(f"must be {words}; got {text!r}") from None

    return read_word


def _path(text: str) -> Path:
    if not text.strip():
        raise ValueError
    return Path(text)


def pair(text: str) -> tuple[str, str]:
    """What stands before an equals sign, and behind it; ValueError where one is missing."""
    name, equals, value = (part.strip() for part in text.partition("="))
    if not (equals and name and value):
        raise ValueError
    return name, value


def _positive(text: str) -> float:
    value = float(text)
    if not 0.0 < value < float("inf"):
        raise ValueError
    return value


def _count(text: str) -> int:
    if (value := int(text)) < 1:
        raise ValueError
    return value


A_NUMBER = "a number such as 0.5, without a unit"
number = reading(float, A_NUMBER)
_whole_number = reading(int, "a whole number")
positive = reading(_positive, "a number above 0")
count = reading(_count, "a whole number of 1 or more")
path = reading(_path, "the name of a file or folder")


def paths(text: str) -> list[Path]:
    """Paths that became one word."""
    return [path(word) for word in text.split(JOIN)]


def number_or(word: str) -> Callable[[str], float | str]:
    """What reads a number or this word from the command line."""
    return reading(lambda text: word if text == word else float(text), f"{word} or {A_NUMBER}")


def one_or_three(text: str) -> float | tuple[float, ...]:
    """A number, or three that became one word."""
    numbers = tuple(map(number, text.replace(JOIN, " ").split() or [text]))
    if len(numbers) not in (1, 3):
        raise argparse.ArgumentTypeError(f"takes one number or three (x y z), got {len(numbers)}")
    return numbers if len(numbers) == 3 else numbers[0]


def is_number(text: str) -> bool:
    """Whether a word that follows is one more number."""
    try:
        float(text)
    except ValueError:
        return False
    return True


def method_name(text: str) -> str:
    """The name of a method. One of the user's own is imported: the module that was named here, and no other."""
    try:
        if is_own_method(text):
            load_method_here(text)
        return str(checked("method", text, RULES["method"]))
    except (MethodError, SettingsError) as error:
        raise argparse.ArgumentTypeError(in_options(error).rstrip(".")) from None


def load_method_here(name: str) -> None:
    """Import the module of a method of one's own, from the folder that the program is called in too.

    Raises MethodError when it cannot be had.
    """
    # As `python -m` has it: the installed program knows the packages alone
    if not {"", os.getcwd()} & set(sys.path):
        sys.path.append(os.getcwd())
    load_method(name)


# ---- what argparse is told


@dataclass(frozen=True)
class _Declared:
    """An option as argparse takes it: its group, its field, and the arguments of `add_argument`."""

    group: type[Options]
    name: str
    words: dict[str, Any]
    belongs: Callable[[str], bool] | None = None  #: Which words that follow are of the same option
    is_tuple: bool = False
    is_output: bool = False


def declared(options: type[Options]) -> Iterator[_Declared]:
    """All options of a class, those of its settings behind its fields."""
    seen: set[str] = set()
    for group in (each for each in options.__mro__ if issubclass(each, Options)):
        meanings, hints = explained(group).parameters, get_type_hints(group, include_extras=True)
        for name in inspect.get_annotations(group):
            if name not in seen and ClassVar not in (hints[name], get_origin(hints[name])):
                seen.add(name)
                yield _declared(options, group, name, hints[name], *meanings.get(name, ("", "")))
        for name in _settings(group.__dict__.get("SETTINGS", ())):
            rule = options.RULES[name]
            if name not in seen and rule["metavar"]:
                seen.add(name)
                unit = f" [{rule['unit']}]" if rule["unit"] else ""
                takes = f"{{{','.join((*(rule['choices'] or ()), OWN_METHOD))}}}" if rule["own"] else rule["metavar"]
                yield _declared(options, group, name, _hint_of(rule), takes, rule["help"] + unit, rule["default"])


def _settings(given: tuple[str | type[Branch], ...]) -> Iterator[str]:
    for each in given:
        yield from [each] if isinstance(each, str) else [spec.name for spec in fields(each)]


def _hint_of(rule: Rule) -> Any:
    """The annotation of a field that takes what a setting does."""
    if rule["kind"] == NUMBERS:
        return Annotated[float, one_or_three, is_number] if 1 in rule["counts"] else tuple.__class_getitem__((float,) * rule["counts"][0])
    if rule["own"]:
        return Annotated[str, method_name]
    if rule["choices"]:
        return Annotated[str, rule["choices"]]
    if rule["word"]:
        return Annotated[float, number_or(rule["word"])]
    return {FLAG: bool, WHOLE: int, WORDS: tuple[str, ...], TEXT: str, FILE: Path}.get(rule["kind"], float)


def _declared(
    options: type[Options], group: type[Options], name: str, hint: Any, takes: str, meaning: str, default: object = None
) -> _Declared:
    kinds = [each for each in get_args(hint) if each is not NoneType] if NoneType in get_args(hint) else [hint]
    kind, *marks = get_args(kinds[0]) if get_origin(kinds[0]) is Annotated else kinds[:1]
    origin, parts, default = get_origin(kind), get_args(kind), getattr(options, name, default)
    words: dict[str, Any] = {"help": meaning if "(default: " in meaning else meaning + _told(default)}
    if kind is bool:
        return _Declared(group, name, {**words, "action": "store_true" if default is False else argparse.BooleanOptionalAction})
    readers = {float: number, int: _whole_number, Path: path, Output: path, str: str}
    functions = [mark for mark in marks if callable(mark)]
    belongs = functions[1] if len(functions) > 1 else None
    words["type"] = functions[0] if functions else readers[parts[0] if origin else kind]
    words["choices"] = next((mark for mark in marks if isinstance(mark, tuple)), None)
    if origin is list:
        words["action"] = "extend" if belongs else "append"
    if origin is tuple:
        words["nargs"] = "+" if parts[-1] is Ellipsis else len(parts)
    if name in options.WORDS and hasattr(options, name):
        words["nargs"] = "?"
    if takes and not words["choices"]:
        words["metavar"] = tuple(takes.split()) if isinstance(words.get("nargs"), int) else takes.split()[0]
    return _Declared(group, name, words, belongs, origin is tuple, Output in (kind, *parts))


def _told(default: object) -> str:
    """The default, in the words of a help."""
    if default is None or isinstance(default, bool) or default in ("", (), []):
        return ""
    each = default if isinstance(default, list | tuple) else [default]
    return f" (default: {' '.join(f'{one:g}' if isinstance(one, float) else str(one) for one in each)})"


class OneLineParser(RefusingParser):
    """A parser of the options of a class, which takes words in any order and tells what may have been meant by a wrong one.

    Parameters
    ----------
    options : type of Options
    prog : str
    shown : sequence of str or None
        Fields that are declared, for a short help; None: all.

    Attributes
    ----------
    spelled : dict of str to _Declared
        Options by the words that name them.
    """

    def __init__(self, options: type[Options], prog: str, shown: Sequence[str] | None = None):
        self._options, self.declared = options, {each.name: each for each in declared(options)}
        needed = [name for name in self.declared if _is_needed(options, name)]
        self._needed = sorted(needed, key=lambda name: name not in options.WORDS)
        self.spelled: dict[str, _Declared] = {}
        super().__init__(
            prog,
            usage=" ".join([prog, *map(self._in_usage, self._needed), "[options]"]),
            description=textwrap.fill(explained(options).summary, max(shutil.get_terminal_size().columns - 2, 11)),
            epilog=f"examples:\n{examples}{options.NOTES}" if (examples := explained(options).examples) else None,
            formatter_class=argparse.RawDescriptionHelpFormatter,
            add_help=False,
        )
        if shown is None:
            self._declare_all()
        else:
            most = self.add_argument_group("what most need")
            for name in dict.fromkeys(shown):
                self._add(most, self.declared[name])

    def parse(self, words: Sequence[str]) -> Options:
        """What the words ask for; WrongArguments says what is wrong with them, SystemExit that the help was shown."""
        self._refuse_unknown(words)
        if asked_for_help := {"-h", "--help", "--help-all"} & set(words):
            short = bool(self._options.FIRST) and "--help-all" not in asked_for_help
            first = (*self._needed, *self._options.FIRST, "help", "help_all")
            print((OneLineParser(self._options, self.prog, first) if short else self).format_help(), end="")
            raise SystemExit(0)
        try:
            asked = self.read(self._joined(words))
        except WrongArguments as wrong:
            # A file may have been joined that is needed elsewhere
            try:
                asked = self.read(self._joined(words, only=is_number))
            except WrongArguments:
                raise wrong from None
        asked.complete()
        return asked

    def read(self, words: Sequence[str]) -> Options:
        """What the words say, each for itself, and nothing that follows from it."""
        asked = self._options()
        self.parse_intermixed_args(words, asked)
        for name, value in vars(asked).items():
            if isinstance(value, list) and self.declared[name].is_tuple:
                setattr(asked, name, tuple(value))
        return asked

    def _declare_all(self) -> None:
        sections: dict[str, Any] = {}
        together: dict[tuple[str, ...], Any] = {}
        for each in self.declared.values():
            title, _, about = ("options" if each.group is self._options else explained(each.group).summary).partition(": ")
            if title not in sections:
                sections[title] = self.add_argument_group(title, about or None)
            section = sections[title]
            names = rivals_of(self._options, each.name)
            if names and names not in together:
                must = not all(hasattr(self._options, name) or name in self._options.RULES for name in names)
                together[names] = section.add_mutually_exclusive_group(required=must)
            self._add(together[names] if names else section, each)

    def _add(self, section: Any, each: _Declared) -> None:
        """Declare an option in a section."""
        if each.name in self._options.WORDS:
            section.add_argument(each.name, **each.words)
            return
        spelled = spelling(self._options, each.name)
        action = section.add_argument(*spelled, dest=each.name, required=each.name in self._needed, **each.words)
        self.spelled |= dict.fromkeys(action.option_strings, each)

    def _in_usage(self, name: str) -> str:
        each = self.declared[name]
        spelled = [] if name in self._options.WORDS else spelling(self._options, name)[:1]
        takes = each.words.get("metavar") or ""
        return " ".join([*spelled, *([takes] if isinstance(takes, str) else takes), *(["..."] if each.words.get("nargs") == "+" else [])])

    def _meant(self, word: str) -> list[str]:
        """The options that a word may name, whole or by its beginning."""
        return [word] if word in self.spelled else [name for name in self.spelled if word.startswith("--") and name.startswith(word)]

    def _refuse_unknown(self, words: Sequence[str]) -> None:
        """Look for mistyped options first; otherwise what is missing without them would be named instead."""
        for word in itertools.takewhile(lambda word: word != "--", words):
            name = word.partition("=")[0]
            meant = self._meant(name)
            if name.startswith("--") and " " not in name and len(meant) != 1:
                near = sorted(meant, key=len) or difflib.get_close_matches(name, self.spelled, n=1)
                either = " or ".join(filter(None, [", ".join(near[:-1]), *near[-1:]]))
                self.error(f"there is no option {name}{f', perhaps {either} is meant' if near else ''}")
            if name.startswith("-") and f"-{name}" in self.spelled:
                self.error(f"there is no option {name}, perhaps -{name} is meant")

    def _joined(self, words: Sequence[str], only: Callable[[str], bool] | None = None) -> list[str]:
        """The same words, but that those which belong to one option are one with it."""
        left, joined = list(words), list[str]()
        while left:
            word = left.pop(0)
            if word == "--":
                # All are files from here on; argparse forgets that on its second look
                return [*joined, *(os.path.join(".", each) for each in left)]
            meant = self._meant(word)
            belongs = self.spelled[meant[0]].belongs if len(meant) == 1 else None
            if belongs is not None and only in (None, belongs) and left:
                taken = [left.pop(0), *itertools.takewhile(belongs, left)]
                left = left[len(taken) - 1 :]
                word = f"{meant[0]}={JOIN.join(taken)}"
            joined.append(word)
        return joined


def spelling(options: type[Options], name: str) -> tuple[str, ...]:
    """The words that name an option."""
    return options.SPELLED.get(name) or (f"--{name.replace('_', '-')}",)


def rivals_of(options: type[Options], name: str) -> tuple[str, ...]:
    """Fields of which one may be given, this one among them; none where it has no rivals."""
    each = [names for group in options.__mro__ for names in group.__dict__.get("RIVALS", ()) if name in names]
    return each[0] if each else ()


def _is_needed(options: type[Options], name: str) -> bool:
    """Whether a field must be given, itself."""
    return not hasattr(options, name) and name not in options.RULES and not rivals_of(options, name)
