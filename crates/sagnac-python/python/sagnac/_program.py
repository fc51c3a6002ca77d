"""The program of this installation, for what runs tests in processes of their own."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import sysconfig
import tempfile
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path as FilePath
from typing import TYPE_CHECKING

from . import _native
from ._errors import ArgumentError, SagnacError
from ._inputs import Path
from ._results import Plan, RunResult

if TYPE_CHECKING:
    from ._documents import Model

# Digits of the id of a test that name the folder of its result.
_FOLDER_DIGITS = 16
_MARKS = {"✓": "agrees", "✗": "differs", "?": "undone", "–": "unchecked"}
_ERROR = 2


def program() -> str:
    """Returns the path of the command ``sagnac`` that was installed with the package.

    Raises:
        ArgumentError: There is none, as in a package that was copied and not installed.
    """
    for folder in (sysconfig.get_path("scripts"), os.path.dirname(sys.executable)):
        found = shutil.which("sagnac", path=folder)
        if found is not None:
            return found
    raise ArgumentError("the command `sagnac` is not installed beside this package; install it with pip")


def _ran(arguments: Sequence[str], lang: str = "en") -> subprocess.CompletedProcess[str]:
    """Runs the program; what it refuses is an error with its diagnostic."""
    done = subprocess.run(
        [program(), *arguments, "--lang", lang],
        capture_output=True,
        text=True,
        encoding="utf-8",
        stdin=subprocess.DEVNULL,
        check=False,
    )
    if done.returncode == _ERROR:
        raise SagnacError(done.stderr.strip())
    if done.returncode < 0 or done.returncode > 3:
        raise SagnacError(f"the program ended with {done.returncode}: {done.stderr.strip()}")
    return done


def _stated(*options: tuple[str, Path | None]) -> list[str]:
    """Options with their files, without those that were left out."""
    return [word for name, path in options if path is not None for word in (name, os.fspath(path))]


@dataclass(frozen=True, slots=True)
class Check:
    """What a check of a folder of results found.

    Attributes:
        state: ``agrees``, ``differs``, ``undone`` (asked for and not made), or ``unchecked``.
        text: What was found, in words.
    """

    state: str
    text: str


@dataclass(frozen=True, slots=True)
class Verification:
    """Whether a folder of results is still what was written: the result of :func:`verify`.

    Attributes:
        whole: Whether every check that was asked for was made and agrees.
        checks: What each found.
    """

    whole: bool
    checks: tuple[Check, ...]

    def __bool__(self) -> bool:
        return self.whole

    def __str__(self) -> str:
        return "\n".join(f"{check.state}: {check.text}" for check in self.checks)


def verify(
    folder: Path,
    *,
    recording: Path | Sequence[Path] = (),
    procedure: Path | None = None,
    limits: Path | None = None,
    signers: Path | None = None,
    lang: str = "en",
) -> Verification:
    """Checks a folder of results: hashes, pages, verdict, signatures, and with its recording every figure.

    Args:
        folder: Folder of results, its record, or a PDF on its own.
        recording: Recording to compute the figures from anew; several of a lot.
        procedure: Procedure of that computation; the copy in the folder without it.
        limits: Limits of that computation; the copy in the folder without them.
        signers: Keys that may sign, as ``allowed_signers`` of OpenSSH.
        lang: Language of the texts, ``en`` or ``ru``.

    Raises:
        SagnacError: There is nothing to verify.
    """
    arguments = ["verify", os.fspath(folder)]
    paths = [recording] if isinstance(recording, (str, os.PathLike)) else recording
    for path in paths:
        arguments += ["--recording", os.fspath(path)]
    arguments += _stated(("--procedure", procedure), ("--limits", limits), ("--signers", signers))
    done = _ran(arguments, lang)
    lines = [line for line in done.stdout.splitlines() if line[:1] in _MARKS and line[1:2] == " "]
    checks = tuple(Check(_MARKS[line[0]], line[2:]) for line in lines)
    return Verification(whole=done.returncode == 0, checks=checks)


def plan(
    explanation: Path,
    model: Path | Model,
    budget: str,
    *,
    temperature_range: tuple[float, float] | None = None,
    ramp_range: tuple[float, float] | None = None,
    table_rates: Sequence[float] | None = None,
    table: bool = True,
    chamber: bool = True,
) -> Plan:
    """Plans the next test: the schedule that tells the explanations of a recording apart.

    Args:
        explanation: Folder of an explanation, its ``explain.json``, or a recording, which is explained first.
        model: Model (TOML) that the next recording will be explained against.
        budget: Longest test with its unit, such as ``8h`` or ``2 d``.
        temperature_range: Lowest and highest temperature of the chamber, °C.
        ramp_range: Slowest and fastest ramp of the chamber, °C/h.
        table_rates: Sizes of the rates of the table, deg/s; each is used in both directions.
        table: False where there is no table.
        chamber: False where there is no chamber.

    Raises:
        SagnacError: A file cannot be read, or an option cannot be used.
    """
    with tempfile.TemporaryDirectory() as scratch:
        out = FilePath(scratch) / "plan"
        if not isinstance(model, (str, os.PathLike)):
            kept = FilePath(scratch) / "model.toml"
            model.write(kept)
            model = kept
        arguments = ["plan", os.fspath(explanation), "--model", os.fspath(model), "--budget", budget]
        for option, span in (("--temperature-range", temperature_range), ("--ramp-range", ramp_range)):
            if span is not None:
                arguments += [f"{option}={span[0]}:{span[1]}"]
        if table_rates is not None:
            arguments += ["--table-rates", ",".join(str(rate) for rate in table_rates)]
        arguments += [] if table else ["--no-table"]
        arguments += [] if chamber else ["--no-chamber"]
        _ran([*arguments, "--out", str(out), "--quiet"])
        schedule = out / "schedule.toml"
        text = schedule.read_text(encoding="utf-8") if schedule.is_file() else None
        return Plan._of(_native.Results.open(str(out)), text)


def watch(
    folder: Path,
    *,
    rules: Path | None = None,
    procedure: Path | None = None,
    limits: Path | None = None,
    out: Path = "watched",
    once: bool = False,
    poll: float = 5.0,
) -> Iterator[RunResult]:
    """Tests every recording that appears in a folder, once, when it is complete; yields each result.

    Args:
        folder: Folder in which recordings appear.
        rules: Rules (TOML): which files are recordings of which test.
        procedure: Procedure for every file of the folder, without rules.
        limits: Limits for every file of the folder.
        out: Folder for results, pages of days and the journal.
        once: Look once, and end.
        poll: Pause between two looks, s.

    Raises:
        SagnacError: The folder, the rules or a procedure cannot be read.
    """
    arguments = ["watch", os.fspath(folder), "--once", "--quiet", "--out", os.fspath(out)]
    arguments += _stated(("--rules", rules), ("--procedure", procedure), ("--limits", limits))
    journal = FilePath(out) / "journal.jsonl"
    known = len(_tests(journal))
    while True:
        failure: SagnacError | None = None
        try:
            _ran(arguments)
        except SagnacError as error:
            failure = error
        tests = _tests(journal)
        for test in tests[known:]:
            found = sorted((FilePath(out) / "results").glob(f"*/{test[:_FOLDER_DIGITS]}*"))
            for result in found:
                yield RunResult._of(_native.Results.open(str(result)), str(result))
        # An exit code of 2 is also that of a recording that could not be tested: its result says so.
        if failure is not None and len(tests) == known:
            raise failure
        known = len(tests)
        if once:
            return
        time.sleep(poll)


def _tests(journal: FilePath) -> list[str]:
    """Ids of the tests in a journal, in their order. A line that was cut by a loss of power is left out."""
    ids: list[str] = []
    if not journal.is_file():
        return ids
    for line in journal.read_text(encoding="utf-8").splitlines():
        try:
            entry = json.loads(line)
        except json.JSONDecodeError:
            continue
        if "tested" in entry:
            ids.append(str(entry["tested"]["test"]["id"]))
    return ids
