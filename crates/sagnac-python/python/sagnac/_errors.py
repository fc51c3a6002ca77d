"""Errors of the package: all are ``ValueError``, and say where the mistake is."""

from __future__ import annotations

__all__ = [
    "ArgumentError",
    "ConfigurationError",
    "NotEvaluableError",
    "OutputError",
    "RecordingError",
    "SagnacError",
]


class SagnacError(ValueError):
    """Why a call gave no result.

    The text is the whole diagnostic, the one that the program prints.

    Attributes:
        file: The file that is wrong, where one is.
        line: Line in it, counted from 1.
        column: Column in characters, counted from 1.
    """

    file: str | None
    line: int | None
    column: int | None

    def __init__(
        self,
        message: str,
        *,
        file: str | None = None,
        line: int | None = None,
        column: int | None = None,
    ) -> None:
        super().__init__(message)
        self.file = file
        self.line = line
        self.column = column


class RecordingError(SagnacError):
    """A recording cannot be opened or read."""


class ConfigurationError(SagnacError):
    """A procedure, a limits file, a manifest or a model is wrong; the text lists every problem."""


class NotEvaluableError(SagnacError):
    """The recording was read and holds too little to evaluate."""


class ArgumentError(SagnacError):
    """An argument cannot be used: an unknown column, a unit that is not an angular rate, and the like."""


class OutputError(SagnacError):
    """A result cannot be rendered or written."""
