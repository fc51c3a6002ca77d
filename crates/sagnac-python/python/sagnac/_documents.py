"""Models, limits and procedures as objects: the tables of a TOML file, made, changed and read in Python."""

from __future__ import annotations

import json
import os
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import date, time
from typing import Any, Self, TypeAlias

from . import _native
from ._errors import ArgumentError, OutputError, RecordingError
from ._inputs import Path


@dataclass(slots=True)
class _Document:
    """Tables of a TOML file.

    Attributes:
        tables: Tables and keys, named as in the file. They may be changed.
        name: What stands for the file in diagnostics and results.
    """

    tables: dict[str, Any] = field(default_factory=dict)
    name: str = "in memory"

    @classmethod
    def read(cls, path: Path) -> Self:
        """Reads the tables of a file. Whether its keys are known is told where it is used.

        Raises:
            RecordingError: The file cannot be read.
            ArgumentError: It is no TOML.
        """
        shown = os.fspath(path)
        try:
            with open(shown, encoding="utf-8") as file:
                return cls.parse(file.read(), name=shown)
        except (OSError, UnicodeDecodeError) as error:
            raise RecordingError(f"{shown}: {error}", file=shown) from error

    @classmethod
    def parse(cls, text: str, *, name: str = "in memory") -> Self:
        """Reads the tables of a text, for example of :attr:`Explanation.augmented`.

        Raises:
            ArgumentError: It is no TOML.
        """
        try:
            return cls(tomllib.loads(text), name)
        except tomllib.TOMLDecodeError as error:
            raise ArgumentError(f"{name}: {error}", file=name) from error

    def to_toml(self) -> str:
        """Returns the text of the file. Lines in diagnostics are lines of it."""
        return _native.toml_text(json.dumps(self.tables, default=_text))

    def write(self, path: Path) -> None:
        """Writes the file.

        Raises:
            OutputError: It cannot be written.
        """
        shown = os.fspath(path)
        try:
            with open(shown, "w", encoding="utf-8") as file:
                file.write(self.to_toml())
        except OSError as error:
            raise OutputError(f"{shown}: {error}", file=shown) from error


class Model(_Document):
    """The expected content of a recording: what :func:`simulate` makes and :func:`explain` starts from."""


class Limits(_Document):
    """Limits that :func:`run` judges by, apart from those of its procedure."""


class Procedure(_Document):
    """A test procedure of one phase."""


Given: TypeAlias = "Path | Mapping[str, Any]"
"""A file, or its tables in memory."""


def given(document: Given | _Document) -> str | tuple[str, str]:
    """Returns a document as the compiled part takes it: a path, or a name and a text."""
    if isinstance(document, (str, os.PathLike)):
        return os.fspath(document)
    if isinstance(document, _Document):
        return document.name, document.to_toml()
    return "in memory", _Document(dict(document)).to_toml()


def _text(value: object) -> str:
    """Dates and times as they stand in a file."""
    return value.isoformat() if isinstance(value, (date, time)) else str(value)
