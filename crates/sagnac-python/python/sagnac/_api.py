"""The functions of the package."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import PurePath
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _native
from ._documents import Given, Limits, Model, Procedure, given
from ._errors import ArgumentError
from ._inputs import Path, Samples, Source, samples, seconds, source
from ._progress import Progress, watching
from ._results import (
    Comparison,
    DataSheet,
    Deviations,
    Explanation,
    Inspection,
    Noise,
    Plan,
    RunResult,
    Simulation,
)


def allan(
    rate: Samples,
    tau0: float,
    *,
    taus: str | Sequence[float] | npt.NDArray[Any] = "octave",
    deviations: str | Sequence[str] = "oadev",
    exact: bool = False,
    progress: Progress = False,
) -> Deviations:
    """Computes deviations of the Allan family with their intervals.

    Contiguous numpy arrays and Arrow arrays are not copied. Values that are no numbers split the record: only terms within unbroken
    stretches are used.

    Args:
        rate: Samples of a rate, shape (n,), in any unit.
        tau0: Sample interval, s.
        taus: Averaging times: ``octave``, ``decade`` (about ten a decade), ``all``, or times in s, each a multiple of ``tau0``.
        deviations: ``oadev`` (overlapping Allan), ``mdev`` (modified), ``hdev`` (overlapping Hadamard), ``totdev`` (total); one or
            several.
        exact: Sum every overlapping term at any length, at 8 bytes a sample. Without it this is done up to four million samples;
            beyond, terms at long averaging times are taken in steps of at most 1/64 of the averaging time.
        progress: True for a bar, or a function of what is being done and the share that is done.

    Returns:
        The curves, in the unit of the samples, with 95 % intervals from the degrees of freedom for the noise that rules at each
        averaging time by the slope of the curve.

    Raises:
        ArgumentError: The samples are no numbers, the interval is not positive, or an averaging time is no multiple of it.
    """
    names = [deviations] if isinstance(deviations, str) else list(deviations)
    values = samples(rate)
    with watching(progress) as tell:
        text, svg = _native.allan(values, float(tau0), seconds(taus), names, exact, tell)
    return Deviations._of(text, svg, float(tau0))


def identify(
    rate: Samples, tau0: float, *, unit: str = "deg/h", progress: Progress = False
) -> Noise:
    """Identifies the noise terms of a gyro at rest.

    Contiguous numpy arrays and Arrow arrays are not copied.

    Args:
        rate: Samples of the rate, shape (n,).
        tau0: Sample interval, s.
        unit: Unit of the samples, for example ``deg/h``, ``deg/s``, ``rad/s``.
        progress: True for a bar, or a function of what is being done and the share that is done.

    Returns:
        N, B, K, R and Q with 95 % intervals, or with bounds where the samples do not resolve them; the Allan deviation; spectral
        lines; and every other quantity of a gyro at rest. Rates in deg/h.

    Raises:
        ArgumentError: The samples are no numbers, or the unit is not an angular rate.
    """
    values = samples(rate)
    with watching(progress) as tell:
        text, drawings = _native.identify(values, float(tau0), unit, tell)
    return Noise._of(text, drawings)


def inspect(
    recording: Source,
    *,
    sample_rate: float | None = None,
    lang: str = "en",
    progress: Progress = False,
) -> Inspection:
    """Tells what a recording holds and which tests it supports.

    Args:
        recording: A path, the paths of its files in order, columns by name, or a DataFrame.
        sample_rate: Sample rate, Hz, where no time column tells it.
        lang: Language of the text, ``en`` or ``ru``.
        progress: True for a bar, or a function of what is being done and the share that is done.

    Raises:
        RecordingError: The recording cannot be opened or read.
    """
    with watching(progress) as tell:
        text, columns = _native.inspect(source(recording), sample_rate, lang, tell)
    return Inspection._of(text, columns)


def analyze(
    recording: Source,
    *,
    rate: str | Sequence[str] = (),
    angle: str | Sequence[str] = (),
    unit: str | None = None,
    time: str | None = None,
    counter: str | None = None,
    sample_rate: float | None = None,
    warm_up: float = 0.0,
    taus: str | Sequence[float] | npt.NDArray[Any] = "octave",
    exact: bool = False,
    progress: Progress = False,
) -> RunResult:
    """Analyses the noise of a recording without a procedure: what ``sagnac analyze`` does.

    Columns tell quantity and unit by their names, as in a file: ``time_s``, ``rate_deg_h``, ``gyro_x_rad_s``, ``temp_degC``.

    Args:
        recording: A path, the paths of its files in order, columns by name, or a DataFrame. Arrays are not copied.
        rate: Rate columns; every column that looks like a gyro output where none is named.
        angle: Columns of accumulated angle, differenced to a rate.
        unit: Unit of the rate columns, where their names do not tell it.
        time: Time column, or ``none`` to use only the sample rate.
        counter: Sample counter, which tells lost and repeated samples.
        sample_rate: Sample rate, Hz, required without a time column.
        warm_up: Time excluded at the start, s.
        taus: Averaging times: ``octave``, ``decade``, ``all``, or times in s.
        exact: Sum every overlapping term at any length, at 8 bytes a sample.
        progress: True for a bar, or a function of what is being done and the share that is done.

    Raises:
        RecordingError: The recording cannot be opened or read.
        NotEvaluableError: Too little of it is usable.
        ArgumentError: A column cannot be used, or the sample rate is not told.
    """
    columns = {
        "rate": [rate] if isinstance(rate, str) else list(rate),
        "angle": [angle] if isinstance(angle, str) else list(angle),
        "unit": unit,
        "counter": counter,
        "time": time,
        "warm_up_s": float(warm_up),
    }
    with watching(progress) as tell:
        native = _native.analyze(
            source(recording), sample_rate, columns, seconds(taus), exact, tell
        )
    return RunResult._of(native, _shown(recording), analysed=True)


def run(
    procedure: Given | Procedure,
    recording: Source,
    *,
    limits: Given | Limits | None = None,
    serial: str | None = None,
    lot: str | None = None,
    operator: str | None = None,
    station: str | None = None,
    progress: Progress = False,
) -> RunResult:
    """Runs a test procedure on a recording: what ``sagnac run`` does. A missed limit is a verdict, not an error.

    Args:
        procedure: Procedure of one phase: a TOML file, or its tables.
        recording: A path, the paths of its files in order, columns by name, or a DataFrame. Arrays are not copied.
        limits: Limits: a TOML file, or its tables; they replace those of the procedure.
        serial: Serial number of the unit.
        lot: Lot of the unit.
        operator: Who tests.
        station: Station of the test.
        progress: True for a bar, or a function of what is being done and the share that is done.

    Raises:
        ConfigurationError: The procedure or the limits file is wrong.
        RecordingError: The recording cannot be opened or read.
        NotEvaluableError: Too little of it is usable.
        ArgumentError: The serial number contradicts a manifest.
    """
    session = {"serial": serial, "lot": lot, "operator": operator, "station": station}
    with watching(progress) as tell:
        native, warnings = _native.run(
            given(procedure),
            source(recording),
            None if limits is None else given(limits),
            session,
            tell,
        )
    return RunResult._of(native, _shown(recording), warnings=warnings)


def explain(
    recording: Source,
    model: Given | Model,
    *,
    alpha: float = 0.01,
    max_effects: int = 3,
    progress: Progress = False,
) -> Explanation:
    """Finds where a recording departs from a model, and which physical effect accounts for it: what ``sagnac explain`` does.

    Args:
        recording: A path, the paths of its files in order, columns by name, or a DataFrame.
        model: Model of the recording: a TOML file, or its tables.
        alpha: Probability that a correct model is called a mismatch.
        max_effects: Most effects that are named.
        progress: True for a bar, or a function of what is being done and the share that is done.

    Raises:
        ConfigurationError: The model is wrong.
        RecordingError: The recording cannot be opened or read.
        ArgumentError: Recording and model cannot be compared.
    """
    with watching(progress) as tell:
        native, times, correction = _native.explain(
            source(recording), given(model), float(alpha), int(max_effects), tell
        )
    if times is None or correction is None:
        return Explanation._of(native, None, None)
    return Explanation._of(native, np.asarray(times), np.asarray(correction))


def simulate(
    model: Given | Model,
    *,
    seed: int | None = None,
    duration: float | None = None,
    progress: Progress = False,
) -> Simulation:
    """Makes a recording from a model. Equal seeds give equal recordings.

    Args:
        model: Model: a TOML file, or its tables.
        seed: Seed of the noise, 0 or more; that of the model where it is left out, else that of the program.
        duration: Length, s; that of the model where it is left out.
        progress: True for a bar, or a function of what is being done and the share that is done.

    Raises:
        ConfigurationError: The model is wrong.
        ArgumentError: No length is stated, or an effect lacks a parameter or a column.
    """
    if seed is not None and seed < 0:
        raise ArgumentError(f"seed: 0 or more is expected, not {seed}")
    with watching(progress) as tell:
        columns, used = _native.simulate(given(model), seed, duration, tell)
    return Simulation(columns={name: np.asarray(values) for name, values in columns}, seed=used)


def compare(*units: RunResult | Path) -> Comparison:
    """Puts Russian against Allan figures of units side by side.

    Args:
        units: Results; or paths: of a ``result.json`` or its folder, else of a recording, which is analysed.

    Raises:
        ArgumentError: A result holds none of the figures that are compared.
        RecordingError: A recording cannot be opened or read.
    """
    if not units:
        raise ArgumentError("compare: at least one result or path is expected")
    compared = []
    for unit in units:
        result = unit if isinstance(unit, RunResult) else _result_of(unit)
        name = PurePath(result._path).name.split(".")[0] or result._path
        compared.append((result._native, name, result._path, result._analysed))
    return Comparison._of(_native.compare(compared))


def datasheet(
    results: Sequence[RunResult | Path], *, proportion: float = 0.95, confidence: float = 0.95
) -> DataSheet:
    """Tells what results of some units promise of the population that the units come from.

    Args:
        results: Results of one model by one procedure; or paths of ``result.json`` files or their folders.
        proportion: Share of the population that a bound holds for, 0.5 to 0.9999.
        confidence: Probability that the promise holds, 0.5 to 0.9999.

    Raises:
        ArgumentError: A file is no result, or the results are of several models or procedures.
    """
    tested: list[str | tuple[_native.Results, str]] = []
    for number, result in enumerate(results, start=1):
        if isinstance(result, RunResult):
            tested.append((result._native, f"result {number}, of {result._path}"))
        else:
            tested.append(os.fspath(result))
    return DataSheet._of(_native.datasheet(tested, proportion, confidence))


def read(path: Path) -> RunResult | Explanation | Comparison | DataSheet | Plan:
    """Reads results back: a ``result.json``, ``explain.json``, ``comparison.json``, ``datasheet.json`` or ``plan.json``, or the folder
    of one.

    Raises:
        ArgumentError: It is no result that this version reads.
    """
    native = _native.Results.open(os.fspath(path))
    kind = native.record_file()
    if kind == "result.json":
        return RunResult._of(native, os.fspath(path))
    if kind == "explain.json":
        return Explanation._of(native, None, None)
    if kind == "comparison.json":
        return Comparison._of(native)
    if kind == "datasheet.json":
        return DataSheet._of(native)
    if kind == "plan.json":
        return Plan._of(native, None)
    raise ArgumentError(f"{os.fspath(path)}: {kind} is read by the program only")


def _result_of(path: Path) -> RunResult:
    shown = os.fspath(path)
    if os.path.isdir(shown) or shown.lower().endswith(".json"):
        found = read(path)
        if not isinstance(found, RunResult):
            raise ArgumentError(f"{shown}: not the result of a run or an analysis")
        return found
    return analyze(path)


def _shown(recording: Source) -> str:
    if isinstance(recording, (str, os.PathLike)):
        return os.fspath(recording)
    if isinstance(recording, Sequence) and recording:
        return str(recording[0])
    return "memory"
