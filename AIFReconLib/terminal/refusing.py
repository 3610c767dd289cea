"""A parser that leaves it to its caller to say what is wrong."""

from __future__ import annotations

import argparse
from typing import NoReturn


class WrongArguments(Exception):
    """What is wrong with the words of a command, in argparse's way."""


class RefusingParser(argparse.ArgumentParser):
    """Raises what is wrong, and neither prints it nor ends the program."""

    def error(self, message: str) -> NoReturn:
        """Raise WrongArguments."""
        raise WrongArguments(message)
