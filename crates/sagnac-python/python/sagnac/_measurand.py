"""Quantities of your own in a test: a function becomes a program that the table ``[[program]]`` of a procedure names.

The program is asked by a line of JSON on standard input and answers by one on standard output, in the protocol ``measurand/1``.
"""

from __future__ import annotations

import contextlib
import json
import math
import sys
import traceback
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, TextIO, TypeAlias

import numpy as np
import numpy.typing as npt

from ._errors import ArgumentError

_PROTOCOL = "measurand/1"


@dataclass(frozen=True)
class Estimate:
    """A value with its unit and its uncertainty: an interval with 95 %, or a standard uncertainty."""

    value: float
    unit: str
    interval: tuple[float, float] | None = None
    standard_uncertainty: float | None = None


@dataclass(frozen=True)
class Unresolved:
    """A quantity that the recording does not show, and why."""

    reason: str


Columns: TypeAlias = "dict[str, npt.NDArray[np.float64]]"
"""Channels by their ids, and the times in s under ``context.time_column``; NaN where a value cannot be used."""


@dataclass(frozen=True)
class Context:
    """What a function is told beside the channels."""

    procedure: Mapping[str, Any]
    """Id and revision of the procedure."""
    unit_under_test: Mapping[str, Any]
    """The unit, such as its serial number."""
    sample_interval_s: float
    """Sample interval, s."""
    units: Mapping[str, str]
    """Unit of each channel."""
    returns: Mapping[str, str]
    """Ids that the procedure asks for, with the units of their rows."""
    time_column: str
    """Name of the column of times."""
    scratch: str
    """Folder in which files may be written."""


Function: TypeAlias = "Callable[[Columns, Context], Mapping[str, Estimate | Unresolved]]"

_registered: list[Function] = []


def measurand(function: Function) -> Function:
    """Declares a function of the channels that gives estimates by their ids; :func:`measurand_main` calls it.

    Several functions of a program each give some of the quantities. The function itself stays as it is.
    """
    _registered.append(function)
    return function


def measurand_main(source: TextIO | None = None, target: TextIO | None = None) -> None:
    """Answers one question of the program by the functions that were declared.

    An error in a function ends the process with exit code 1; the report then shows its message.

    Raises:
        ArgumentError: The question is of another protocol, no function was declared, or two give the same quantity.
    """
    out = sys.stdout if target is None else target
    question = json.loads((sys.stdin if source is None else source).readline())
    if question.get("format") != _PROTOCOL:
        raise ArgumentError(f"a question in {_PROTOCOL} is expected, not in {question.get('format')!r}")
    if not _registered:
        raise ArgumentError("no function was declared with @sagnac.measurand")
    columns, context = _read(question)
    estimates: dict[str, Estimate | Unresolved] = {}
    try:
        # What a function prints is no part of the answer.
        with contextlib.redirect_stdout(sys.stderr):
            for function in _registered:
                given = function(columns, context)
                twice = sorted(estimates.keys() & given.keys())
                if twice:
                    raise ArgumentError(f"two functions give {', '.join(twice)}")
                estimates.update(given)
    except Exception as error:
        # The report shows the beginning of what is said.
        print(f"{type(error).__name__}: {error}", file=sys.stderr)
        traceback.print_exc()
        raise SystemExit(1) from error
    answer = [_answer(name, estimate) for name, estimate in estimates.items()]
    print(json.dumps({"format": _PROTOCOL, "estimates": answer}, allow_nan=False), file=out, flush=True)


def _read(question: Mapping[str, Any]) -> tuple[Columns, Context]:
    """Reads the channels of a question, and what it says beside them."""
    columns = {column["id"]: np.fromfile(column["file"], dtype="<f8") for column in question["columns"]}
    context = Context(
        procedure=question["procedure"],
        unit_under_test=question["unit"],
        sample_interval_s=question["sample_interval_s"],
        units={column["id"]: column["unit"] for column in question["columns"]},
        returns={asked["id"]: asked["unit"] for asked in question["returns"]},
        time_column=question["columns"][0]["id"],
        scratch=question["scratch"],
    )
    return columns, context


def _answer(name: str, estimate: Estimate | Unresolved) -> dict[str, Any]:
    """One estimate as the protocol has it. A value that is no number is unresolved."""
    if isinstance(estimate, Unresolved):
        return {"id": name, "unresolved": estimate.reason}
    if not math.isfinite(estimate.value):
        return {"id": name, "unresolved": f"the value is {estimate.value}"}
    answer: dict[str, Any] = {"id": name, "unit": estimate.unit, "value": float(estimate.value)}
    if estimate.interval is not None:
        answer["interval"] = [float(bound) for bound in estimate.interval]
    if estimate.standard_uncertainty is not None:
        answer["standard_uncertainty"] = float(estimate.standard_uncertainty)
    return answer
