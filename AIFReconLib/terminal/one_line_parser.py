"""argparse as a user wants it: one line of what is wrong and what was meant, help that fits a screen, words in any order."""

from __future__ import annotations

import argparse
import difflib
import itertools
import textwrap
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, NoReturn

from ..message import LONGEST_QUOTE, one_line, shorten

BAD_INPUT = 2
"""Exit code of wrong arguments or input."""

OPTIONS_WIDTH = 32
"""Columns of a short help for the options, left of what they mean."""

SPACING_NUMBERS = 3
"""Most numbers of an option that `NumbersAction` declares."""


def numbers(text: str) -> tuple[float, ...]:
    """What reads the words that the parser joined for a `NumbersAction`."""
    return tuple(map(_number, text.split())) or (_number(text),)


class TakingAction(argparse.Action):
    """An option whose value is what `taken` makes of its words."""

    def __call__(
        self,
        parser: argparse.ArgumentParser,
        namespace: argparse.Namespace,
        values: Any,
        option_string: str | None = None,
    ) -> None:
        """Take them."""
        setattr(namespace, self.dest, self.taken(values, getattr(namespace, self.dest)))

    def taken(self, given: Any, before: Any) -> object:
        """The value for these words, where it has been `before` so far."""
        raise NotImplementedError


class NumbersAction(TakingAction):
    """One number, or three; the parser takes no more words for it than are numbers, so that a file may follow."""

    def taken(self, given: tuple[float, ...], before: object) -> object:
        """The number, or the three."""
        if len(given) not in (1, SPACING_NUMBERS):
            raise argparse.ArgumentError(self, f"takes one number or three (x y z), got {len(given)}")
        return given[0] if len(given) == 1 else given


class FilesAction(TakingAction):
    """Files, as often as wanted and several at a time; collected in a list. `belongs` tells which of the words that follow may be more."""

    def __init__(self, option_strings: Sequence[str], dest: str, belongs: Callable[[str], bool] = lambda word: False, **options: Any):
        super().__init__(option_strings, dest, **options)
        self.belongs = belongs

    def taken(self, given: Path, before: list[Path] | None) -> list[Path]:
        """Those before, and one more."""
        return [*(before or []), given]


class AllHelpAction(argparse.Action):
    """Shows every option and exits."""

    def __call__(
        self,
        parser: argparse.ArgumentParser,
        namespace: argparse.Namespace,
        values: str | Sequence[object] | None,
        option_string: str | None = None,
    ) -> NoReturn:
        """Show them."""
        print(argparse.ArgumentParser.format_help(parser), end="")
        parser.exit()


class OneLineParser(argparse.ArgumentParser):
    """Reports wrong arguments in one line, like every other error, and says what may have been meant. Its help ends with `examples`."""

    def __init__(self, *arguments: Any, examples: str = "", **options: Any):
        if examples:
            options |= {"epilog": examples, "formatter_class": argparse.RawDescriptionHelpFormatter}
        super().__init__(*arguments, **options)
        self.register("type", float, _number)
        self.register("type", int, _whole_number)
        self.register("type", Path, _path)
        self._short: tuple[str, ...] = ()
        self.defaults_from: Callable[[argparse.Namespace], Mapping[str, object]] | None = None

    def show_first(self, *names: str) -> None:
        """Let -h show what must be given and the options that are kept under these names, in this order, and --help-all all."""
        self.add_argument("--help-all", action=AllHelpAction, nargs=0, help="show every option")
        self._short = (*names, "help", "help_all")
        # That of argparse names every option once more
        needed = [action for action in self._actions if action.required]
        words = [
            " ".join([*action.option_strings[:1], str(action.metavar), *(["..."] if action.nargs == "+" else [])]) for action in needed
        ]
        self.usage = " ".join([self.prog, *words, "[options]"])

    def format_help(self) -> str:
        """What -h shows."""
        if not self._short:
            return super().format_help()
        formatter = argparse.RawDescriptionHelpFormatter(prog=self.prog, max_help_position=OPTIONS_WIDTH)
        formatter.add_usage(self.usage, self._actions, [])
        formatter.add_text(textwrap.fill(self.description or "", formatter._width))
        formatter.start_section("what most need")
        of_name = {action.dest: action for action in self._actions}
        needed = [action for action in self._actions if action.required]
        formatter.add_arguments([*needed, *(of_name[name] for name in self._short)])
        formatter.end_section()
        formatter.add_text(self.epilog)
        return formatter.format_help()

    def parse_known_args(  # type: ignore[override]  # argparse calls it with these; its overloads are of namespaces of other kinds
        self, args: Sequence[str] | None = None, namespace: argparse.Namespace | None = None
    ) -> tuple[argparse.Namespace, list[str]]:
        """Look for mistyped options first; otherwise what is missing without them would be named instead."""
        if args is None or self._subparsers is not None:
            return super().parse_known_args(args, namespace)
        self._refuse_unknown(args)
        words = self._with_files_apart(self._with_numbers_joined(args))
        if self.defaults_from is not None:
            # What was given comes before what it leads to, so it is read twice
            self.set_defaults(**self.defaults_from(super().parse_known_args(words, None)[0]))
        found, left = super().parse_known_args(words, namespace)
        several = next((action for action in self._actions if not action.option_strings and action.nargs == "+"), None)
        if several is not None:
            # argparse takes them in one run; options may stand between them
            files = [word for word in left if not word.startswith("-")]
            getattr(found, several.dest).extend(self._get_value(several, word) for word in files)
            left = [word for word in left if word not in files]
        return found, left

    def _refuse_unknown(self, given: Sequence[str]) -> None:
        known = list(self._option_string_actions)
        for word in itertools.takewhile(lambda word: word != "--", given):
            name = word.partition("=")[0]
            if " " in name or name in known:
                continue
            if name.startswith("--"):
                meant = [option for option in known if option.startswith(name)]
                if len(meant) == 1:
                    continue
                near = sorted(meant, key=len) or difflib.get_close_matches(name, known, n=1)
                self.error(f"there is no option {name}{f', perhaps {_either(near)} is meant' if near else ''}")
            if f"-{name}" in known:
                self.error(f"there is no option {name}, perhaps -{name} is meant")

    def _with_numbers_joined(self, given: Sequence[str]) -> list[str]:
        """The same words; the numbers after an option that takes several become one word with it."""
        words: list[str] = []
        left = list(given)
        while left:
            word = left.pop(0)
            if word == "--":
                return [*words, word, *left]
            if self._takes_numbers(word):
                numbers = list(itertools.takewhile(_is_number, left[:SPACING_NUMBERS]))
                left = left[len(numbers) :]
                word = f"{word}={' '.join(numbers)}" if numbers else word
            words.append(word)
        return words

    def _with_files_apart(self, given: Sequence[str]) -> list[str]:
        """The same words, the option repeated for every file of a `FilesAction`; where nothing else would be left, it takes one."""
        words: list[str] = []
        others = 0
        left = list(given)
        runs: list[tuple[int, str, list[str]]] = []
        while left:
            word = left.pop(0)
            words.append(word)
            action = self._option_string_actions.get(word)
            if word == "--":
                words += left
                break
            if isinstance(action, FilesAction) and left:
                words.append(left.pop(0))
                tail = list(itertools.takewhile(action.belongs, left))
                left = left[len(tail) :]
                runs.append((len(words), word, tail))
                words += tail
            elif action is not None:
                count = action.nargs if isinstance(action.nargs, int) else 1
                taken = list(itertools.takewhile(lambda each: not each.startswith("--"), left)) if action.nargs == "+" else left[:count]
                words += taken
                left = left[len(taken) :]
            else:
                others += not word.startswith("-")
        positional = any(not action.option_strings and action.nargs not in ("?", "*") for action in self._actions)
        for at, option, tail in reversed(runs if others or not positional else []):
            words[at : at + len(tail)] = [each for file in tail for each in (option, file)]
        return words

    def _takes_numbers(self, word: str) -> bool:
        known = self._option_string_actions
        meant = [word] if word in known else [option for option in known if word.startswith("--") and option.startswith(word)]
        return len(meant) == 1 and isinstance(known[meant[0]], NumbersAction)

    def _check_value(self, action: argparse.Action, value: Any) -> None:
        """Suggest the command that may have been meant, instead of listing all."""
        if isinstance(action, argparse._SubParsersAction) and value not in action.choices:
            near = difflib.get_close_matches(value, action.choices, n=1)
            self.error(f"there is no command {value}{f', perhaps {near[0]} is meant' if near else ''}")
        super()._check_value(action, value)

    def error(self, message: str) -> NoReturn:
        """Say what is wrong and where help is, and exit."""
        self.exit(BAD_INPUT, f"{self.prog}: {one_line(shorten(message, LONGEST_QUOTE))}. See {self.prog} --help.\n")


def _either(names: Sequence[str]) -> str:
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} or {names[-1]}"


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"must be a number such as 0.5, without a unit; got {text!r}") from None


def _path(text: str) -> Path:
    if not text.strip():
        raise argparse.ArgumentTypeError(f"must be the name of a file or folder; got {text!r}")
    return Path(text)


def _whole_number(text: str) -> int:
    try:
        return int(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"must be a whole number; got {text!r}") from None
