"""Results of runs, analyses, explanations, comparisons and data sheets: frozen, with named fields."""

from __future__ import annotations

import html
import json
import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _native, _plots
from ._errors import ArgumentError
from ._frames import frame
from ._inputs import Path
from ._values import (
    AllanCurve,
    Column,
    Condition,
    Figure,
    Interval,
    Line,
    Measurand,
    allan_curve,
    measurand,
)


@lru_cache(maxsize=64)
def _figures(results: _native.Results, lang: str) -> tuple[Figure, ...]:
    return tuple(Figure(*figure) for figure in results.figures(lang))


def _table(heads: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
    def cells(tag: str, row: Sequence[object]) -> str:
        return "".join(f"<{tag}>{html.escape(_shown(cell))}</{tag}>" for cell in row)

    body = "".join(f"<tr>{cells('td', row)}</tr>" for row in rows)
    return f"<table><thead><tr>{cells('th', heads)}</tr></thead><tbody>{body}</tbody></table>"


def _shown(cell: object) -> str:
    if cell is None:
        return "–"
    return f"{cell:.6g}" if isinstance(cell, float) else str(cell)


def _estimate(m: Measurand) -> str:
    """The value, or the bound where the recording does not show one."""
    if m.value is None and m.upper_limit is not None:
        return f"< {m.upper_limit.value:.4g} ({100 * m.upper_limit.level:g} %)"
    return _shown(m.value)


def _span(interval: Interval | None) -> str:
    return "–" if interval is None else f"{interval[0]:.6g} … {interval[1]:.6g}"


@dataclass(frozen=True, slots=True, repr=False)
class Result:
    """What every result has: its record, its figures and tables, and a way into files."""

    _native: _native.Results = field(compare=False)

    def to_dict(self) -> dict[str, Any]:
        """Returns the whole record, as the JSON file of the result holds it."""
        record: dict[str, Any] = json.loads(self._native.json())
        return record

    def figures(self, lang: str = "en") -> tuple[Figure, ...]:
        """Returns the figures in the order of the report, drawn in a language (``en``, ``ru``)."""
        return _figures(self._native, lang)

    def tables(self) -> dict[str, str]:
        """Returns the tables beside the record: text by file name."""
        return dict(self._native.tables())

    def write(self, folder: Path, *, forms: Sequence[str] = (), lang: str = "en") -> None:
        """Writes the result into a folder, which is created where it is missing.

        Args:
            folder: The folder. Files of the same names are replaced.
            forms: Forms by the names that ``sagnac report --format`` knows, such as ``html``, ``docx``, ``parquet``; those
                that the program writes unasked where none is named.
            lang: Language of the report, ``en`` or ``ru``.

        Raises:
            OutputError: A file cannot be written.
            ArgumentError: A form or a language is not known.
        """
        self._native.write(os.fspath(folder), list(forms), lang)

    def _drawn(self) -> str:
        return "".join(f"<div>{figure.svg}</div>" for figure in self.figures())


@dataclass(frozen=True, slots=True, repr=False)
class RunResult(Result):
    """The result of :func:`run` or :func:`analyze`.

    Attributes:
        verdict: ``pass``, ``fail``, ``indeterminate``, ``error``, or ``none`` without limits.
        serial: Serial number of the unit.
        summary: Why the verdict is what it is.
        measurands: Measured quantities, in the order of the report.
        conditions: Conditions of the test.
        lines: Spectral lines.
        faults: Faults of the recording: counts by kind, only those that occur.
        warnings: Warnings about the procedure and its limits.
    """

    verdict: str
    serial: str | None
    summary: tuple[str, ...]
    measurands: tuple[Measurand, ...]
    conditions: tuple[Condition, ...]
    lines: tuple[Line, ...]
    faults: dict[str, int]
    warnings: tuple[str, ...]
    _path: str = field(compare=False)
    _analysed: bool = field(compare=False)

    @classmethod
    def _of(
        cls,
        native: _native.Results,
        path: str,
        *,
        analysed: bool = False,
        warnings: Sequence[str] = (),
    ) -> RunResult:
        record: dict[str, Any] = json.loads(native.json())
        integrity = record["integrity"]
        return cls(
            _native=native,
            verdict=record["verdict"],
            serial=record["unit_under_test"].get("serial"),
            summary=tuple(note["text"] for note in record["summary"]),
            measurands=tuple(measurand(m) for m in record["measurands"]),
            conditions=tuple(
                Condition(
                    id=c["id"],
                    status=c["status"],
                    required=c.get("required"),
                    observed=c.get("observed"),
                    note=_text(c.get("note")),
                )
                for c in record["conditions"]
            ),
            lines=tuple(
                Line(line["frequency_hz"], line["amplitude_deg_h"]) for line in record["lines"]
            ),
            faults={
                kind: count
                for kind, count in integrity.items()
                if isinstance(count, int) and not isinstance(count, bool) and count > 0
            },
            warnings=tuple(warnings),
            _path=path,
            _analysed=analysed,
        )

    @property
    def path(self) -> str:
        """Where the result was read from; of one that was made here, its recording."""
        return self._path

    def measurand(self, id: str, channel: str | None = None) -> Measurand:
        """Returns a measured quantity by its id: the first, where several channels have it and none is named.

        Raises:
            KeyError: The result does not hold it.
        """
        for one in self.measurands:
            if one.id == id and channel in (None, one.channel):
                return one
        raise KeyError(id if channel is None else f"{id} of {channel}")

    def __getitem__(self, id: str) -> Measurand:
        return self.measurand(id)

    def __iter__(self) -> Iterator[Measurand]:
        return iter(self.measurands)

    def __len__(self) -> int:
        return len(self.measurands)

    def allan(self, channel: str | None = None, estimator: str = "oadev") -> AllanCurve:
        """Returns a deviation at octaves, as the record holds it; ``terms``, ``stride`` and ``noise`` are not in the record and empty.

        Raises:
            KeyError: The result does not hold it.
        """
        rows = [
            d
            for d in self.to_dict()["deviations"]
            if d["estimator"] == estimator and channel in (None, d["channel"])
        ]
        if not rows:
            raise KeyError(estimator if channel is None else f"{estimator} of {channel}")
        first = rows[0]["channel"]
        points = [
            {
                "tau_s": d["tau_s"],
                "deviation": d["deviation_deg_h"],
                "low": d["low_deg_h"],
                "high": d["high_deg_h"],
                "edf": d["edf"],
                "terms": 0,
                "stride": 0,
                "noise": "",
            }
            for d in rows
            if d["channel"] == first
        ]
        return allan_curve(estimator, points)

    def plot(self, ax: Any = None, channel: str | None = None) -> Any:
        """Draws the Allan deviation of a channel with its intervals; returns the axes of matplotlib.

        Raises:
            KeyError: The result holds no deviation, as that of a rate table.
        """
        return _plots.deviations([self.allan(channel)], "deg/h", ax)

    def to_frame(self, library: str | None = None) -> Any:
        """Returns the measurands as a DataFrame, one row each, of ``pandas`` or ``polars``."""
        return frame([_measurand_row(m) for m in self.measurands], library)

    def __repr__(self) -> str:
        unit = "" if self.serial is None else f", serial {self.serial}"
        return f"<RunResult: {self.verdict}{unit}, {len(self)} measurands>"

    def __str__(self) -> str:
        return "\n".join([repr(self), *self.summary, *map(str, self.measurands)])

    def _repr_html_(self) -> str:
        rows = [
            (m.id, m.channel, _estimate(m), m.unit, _span(m.interval), m.verdict) for m in self.measurands
        ]
        heads = ("measurand", "channel", "value", "unit", "95 % interval", "verdict")
        summary = "".join(f"<p>{html.escape(line)}</p>" for line in self.summary)
        return f"<p><b>{html.escape(self.verdict)}</b></p>{summary}{_table(heads, rows)}{self._drawn()}"


def _text(note: Any) -> str | None:
    if isinstance(note, dict):
        text = note.get("text")
        return None if text is None else str(text)
    return note if note is None else str(note)


def _measurand_row(m: Measurand) -> dict[str, Any]:
    low, high = m.interval if m.interval is not None else (None, None)
    return {
        "id": m.id,
        "channel": m.channel,
        "value": m.value,
        "unit": m.unit,
        "low": low,
        "high": high,
        "level": m.level,
        "identifiable": m.identifiable,
        "upper_limit": None if m.upper_limit is None else m.upper_limit.value,
        "limit_min": None if m.limit is None else m.limit.min,
        "limit_max": None if m.limit is None else m.limit.max,
        "verdict": m.verdict,
        "method": m.method,
    }


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Noise:
    """Noise of a gyro at rest, from its samples: the result of :func:`identify`.

    Attributes:
        measurands: Terms and every other quantity of a gyro at rest.
        allan: Overlapping Allan deviation at octaves, deg/h, with intervals for the identified noise.
        lines: Spectral lines.
    """

    measurands: tuple[Measurand, ...]
    allan: AllanCurve
    lines: tuple[Line, ...]
    _drawings: tuple[Figure, ...]

    @classmethod
    def _of(cls, text: str, drawings: list[tuple[str, str, str]]) -> Noise:
        found = json.loads(text)
        return cls(
            measurands=tuple(measurand(m) for m in found["measurands"]),
            allan=allan_curve("oadev", found["allan"]),
            lines=tuple(
                Line(line["frequency_hz"], line["amplitude_deg_h"]) for line in found["lines"]
            ),
            _drawings=tuple(Figure(*figure) for figure in drawings),
        )

    @property
    def terms(self) -> tuple[Measurand, ...]:
        """N, B, K, R and Q."""
        ids = (
            "angle_random_walk",
            "bias_instability",
            "rate_random_walk",
            "rate_ramp",
            "quantization",
        )
        return tuple(self[id] for id in ids)

    def plot(self, ax: Any = None) -> Any:
        """Draws the deviation with its intervals; returns the axes of matplotlib."""
        return _plots.deviations([self.allan], "deg/h", ax)

    def figures(self) -> tuple[Figure, ...]:
        """Returns the drawing of the deviation with the identified terms."""
        return self._drawings

    def __getitem__(self, id: str) -> Measurand:
        for one in self.measurands:
            if one.id == id:
                return one
        raise KeyError(id)

    def __iter__(self) -> Iterator[Measurand]:
        return iter(self.measurands)

    def __len__(self) -> int:
        return len(self.measurands)

    def to_dict(self) -> dict[str, Any]:
        """Returns the measurands, the deviation and the lines as dictionaries and lists."""
        return {
            "measurands": [m.to_dict() for m in self.measurands],
            "allan": self.allan.to_dict(),
            "lines": [
                {"frequency_hz": line.frequency_hz, "amplitude_deg_h": line.amplitude_deg_h}
                for line in self.lines
            ],
        }

    def to_frame(self, library: str | None = None) -> Any:
        """Returns the measurands as a DataFrame, one row each, of ``pandas`` or ``polars``."""
        return frame([_measurand_row(m) for m in self.measurands], library)

    def __repr__(self) -> str:
        return "<Noise: " + "; ".join(map(str, self.terms)) + ">"

    def _repr_html_(self) -> str:
        rows = [(m.id, _estimate(m), m.unit, _span(m.interval)) for m in self.measurands]
        drawn = "".join(f"<div>{figure.svg}</div>" for figure in self._drawings)
        return _table(("measurand", "value", "unit", "95 % interval"), rows) + drawn


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Deviations:
    """Deviations of the Allan family: the result of :func:`allan`.

    Attributes:
        curves: One curve for each deviation that was asked for, in that order.
        tau0_s: Sample interval, s.
    """

    curves: tuple[AllanCurve, ...]
    tau0_s: float
    _svg: str

    @classmethod
    def _of(cls, text: str, svg: str, tau0_s: float) -> Deviations:
        curves = tuple(allan_curve(c["estimator"], c["points"]) for c in json.loads(text))
        return cls(curves=curves, tau0_s=tau0_s, _svg=svg)

    def __getitem__(self, estimator: str) -> AllanCurve:
        for curve in self.curves:
            if curve.estimator == estimator:
                return curve
        raise KeyError(estimator)

    def __iter__(self) -> Iterator[AllanCurve]:
        return iter(self.curves)

    def __len__(self) -> int:
        return len(self.curves)

    @property
    def tau_s(self) -> npt.NDArray[np.float64]:
        """Averaging times of the first curve, s."""
        return self.curves[0].tau_s

    @property
    def deviation(self) -> npt.NDArray[np.float64]:
        """Deviations of the first curve, in the unit of the samples."""
        return self.curves[0].deviation

    @property
    def intervals(self) -> tuple[Interval, ...]:
        """(low, high) of the first curve, at its ``level``."""
        return self.curves[0].intervals

    def to_dict(self) -> dict[str, Any]:
        """Returns the columns of each curve, by the name of its deviation."""
        return {curve.estimator: curve.to_dict() for curve in self.curves}

    def to_frame(self, library: str | None = None) -> Any:
        """Returns the points of all curves as a DataFrame of ``pandas`` or ``polars``."""
        rows: list[dict[str, Any]] = []
        for curve in self.curves:
            columns = curve.to_dict()
            rows.extend(
                dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)
            )
        return frame(rows, library)

    def plot(self, ax: Any = None) -> Any:
        """Draws the curves with their intervals; returns the axes of matplotlib."""
        return _plots.deviations(self.curves, "unit of the samples", ax)

    def figures(self) -> tuple[Figure, ...]:
        """Returns the drawing of the curves."""
        return (Figure("deviations", "deviations.svg", self._svg),)

    def __repr__(self) -> str:
        names = ", ".join(f"{curve.estimator} ({len(curve)} points)" for curve in self.curves)
        return f"<Deviations: {names}>"

    def _repr_html_(self) -> str:
        return f"<div>{self._svg}</div>"


@dataclass(frozen=True, slots=True)
class Parameter:
    """A parameter of an effect.

    Attributes:
        value: Its value.
        unit: Its unit.
        interval: (low, high) at ``level``.
        level: Coverage of the interval, 0.95.
    """

    value: float
    unit: str
    interval: Interval | None
    level: float = 0.95


@dataclass(frozen=True, slots=True)
class Effect:
    """Something that a recording shows and its model lacks.

    Attributes:
        kind: Its kind, ``unknown`` where no effect of the catalogue accounts for it.
        equivalents: Kinds that this recording cannot tell from it.
        parameters: Its parameters by name.
        where: Where it lives: dictionaries with ``domain``, ``from`` and ``to``.
        p_value: Probability of such a find without the effect.
    """

    kind: str
    equivalents: tuple[str, ...]
    parameters: dict[str, Parameter]
    where: tuple[dict[str, Any], ...]
    p_value: float | None


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Explanation(Result):
    """Where a recording departs from its model, and because of what: the result of :func:`explain`.

    Attributes:
        verdict: ``consistent``, ``mismatch`` or ``unknown-mismatch``.
        effects: What was left out, the principal effect first.
        augmented: The model with the effects added, as the text of a TOML file.
        time_s: Times of the correction, or ``None`` where what was left out cannot be predicted.
        correction_deg_h: What the model left out at each of these times, deg/h.
    """

    verdict: str
    effects: tuple[Effect, ...]
    augmented: str
    time_s: npt.NDArray[np.float64] | None
    correction_deg_h: npt.NDArray[np.float64] | None

    @classmethod
    def _of(
        cls,
        native: _native.Results,
        time_s: npt.NDArray[np.float64] | None,
        correction: npt.NDArray[np.float64] | None,
    ) -> Explanation:
        record: dict[str, Any] = json.loads(native.json())
        return cls(
            _native=native,
            verdict=record["verdict"],
            effects=tuple(_effect(e) for e in record["effects"]),
            augmented=dict(native.tables())["augmented.toml"],
            time_s=time_s,
            correction_deg_h=correction,
        )

    def plot(self, ax: Any = None) -> Any:
        """Draws what the model left out over time; returns the axes of matplotlib.

        Raises:
            ArgumentError: What was left out cannot be predicted, or the explanation was read back, without its recording.
        """
        if self.time_s is None or self.correction_deg_h is None:
            raise ArgumentError("plot: this explanation has no course of what was left out; see figures()")
        return _plots.course(self.time_s, self.correction_deg_h, "left out by the model, deg/h", ax)

    def to_frame(self, library: str | None = None) -> Any:
        """Returns the parameters of all effects as a DataFrame of ``pandas`` or ``polars``, one row each."""
        rows = [
            {
                "effect": effect.kind,
                "parameter": name,
                "value": p.value,
                "unit": p.unit,
                "low": None if p.interval is None else p.interval[0],
                "high": None if p.interval is None else p.interval[1],
                "level": p.level,
            }
            for effect in self.effects
            for name, p in effect.parameters.items()
        ]
        return frame(rows, library)

    def __repr__(self) -> str:
        return f"<Explanation: {self.verdict}" + "".join(f", {e.kind}" for e in self.effects) + ">"

    def _repr_html_(self) -> str:
        rows = [
            (effect.kind, name, p.value, p.unit, _span(p.interval))
            for effect in self.effects
            for name, p in effect.parameters.items()
        ]
        heads = ("effect", "parameter", "value", "unit", "95 % interval")
        return f"<p><b>{html.escape(self.verdict)}</b></p>{_table(heads, rows)}{self._drawn()}"


def _effect(record: dict[str, Any]) -> Effect:
    where = record.get("where") or []
    parameters = {
        name: Parameter(
            value=p["value"],
            unit=p["unit"],
            interval=None if p.get("ci95") is None else (p["ci95"][0], p["ci95"][1]),
        )
        for name, p in record["parameters"].items()
    }
    return Effect(
        kind=record["kind"],
        equivalents=tuple(record["equivalents"]),
        parameters=parameters,
        where=tuple(where) if isinstance(where, list) else (where,),
        p_value=record.get("p_value"),
    )


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Comparison(Result):
    """Russian against Allan figures of units: the result of :func:`compare`.

    Attributes:
        units: One entry for each unit and channel: dictionaries, as ``comparison.json`` holds them.
    """

    units: tuple[dict[str, Any], ...]

    @classmethod
    def _of(cls, native: _native.Results) -> Comparison:
        return cls(_native=native, units=tuple(json.loads(native.json())["units"]))

    def plot(self, ax: Any = None, id: str = "ratio_russian_to_allan_bias") -> Any:
        """Draws a quantity of every unit with its interval; returns the axes of matplotlib.

        Raises:
            KeyError: No unit has the quantity.
        """
        rows = [
            (unit["name"], q["value"], None if q.get("interval") is None else (q["interval"]["low"], q["interval"]["high"]))
            for unit in self.units
            for q in unit["quantities"]
            if q["id"] == id and q["value"] is not None
        ]
        if not rows:
            raise KeyError(id)
        return _plots.estimates(rows, id, ax)

    def to_frame(self, library: str | None = None) -> Any:
        """Returns the compared quantities as a DataFrame of ``pandas`` or ``polars``, one row for a quantity of a unit."""
        rows = [
            {
                "unit": unit["name"],
                "channel": unit["channel"],
                "id": q["id"],
                "value": q["value"],
                "unit_of_value": q["unit"],
                "low": None if q.get("interval") is None else q["interval"]["low"],
                "high": None if q.get("interval") is None else q["interval"]["high"],
            }
            for unit in self.units
            for q in unit["quantities"]
        ]
        return frame(rows, library)

    def __repr__(self) -> str:
        return "<Comparison: " + ", ".join(unit["name"] for unit in self.units) + ">"

    def _repr_html_(self) -> str:
        rows = [
            (unit["name"], unit["channel"], q["id"], q["value"], q["unit"])
            for unit in self.units
            for q in unit["quantities"]
        ]
        return _table(("unit", "channel", "quantity", "value", "unit"), rows) + self._drawn()


@dataclass(frozen=True, slots=True)
class SheetBound:
    """A bound of a data sheet: with ``confidence``, at least ``proportion`` of the population lie within it.

    Attributes:
        of: ``true`` values of the units, or values ``measured`` by one test.
        side: ``upper`` or ``lower``.
        value: The bound; ``None`` where the units do not support one.
        proportion: Share of the population.
        confidence: Probability, over lots drawn, that the promise holds.
    """

    of: str
    side: str
    value: float | None
    proportion: float
    confidence: float


@dataclass(frozen=True, slots=True)
class SheetQuantity:
    """A quantity of a data sheet.

    Attributes:
        id: Id of the measurand.
        channel: Channel.
        unit: Unit of all values.
        units: Units that it was measured on.
        typical: Median of the population, or ``None``.
        interval: (low, high) of it at ``level``.
        level: Coverage of the interval.
        bounds: What is promised.
    """

    id: str
    channel: str
    unit: str
    units: int
    typical: float | None
    interval: Interval | None
    level: float | None
    bounds: tuple[SheetBound, ...]


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class DataSheet(Result):
    """What the results of some units promise of the population that they come from: the result of :func:`datasheet`.

    Attributes:
        model: Model of the units.
        units: Number of units.
        lots: Number of lots.
        quantities: Quantities with their bounds.
    """

    model: str | None
    units: int
    lots: int
    quantities: tuple[SheetQuantity, ...]

    @classmethod
    def _of(cls, native: _native.Results) -> DataSheet:
        record: dict[str, Any] = json.loads(native.json())
        return cls(
            _native=native,
            model=record["model"],
            units=record["units"],
            lots=record["lots"],
            quantities=tuple(_quantity(q) for q in record["quantities"]),
        )

    def __getitem__(self, id: str) -> SheetQuantity:
        for quantity in self.quantities:
            if quantity.id == id:
                return quantity
        raise KeyError(id)

    def to_frame(self, library: str | None = None) -> Any:
        """Returns the bounds as a DataFrame of ``pandas`` or ``polars``, one row each."""
        rows = [
            {
                "id": q.id,
                "channel": q.channel,
                "unit": q.unit,
                "units": q.units,
                "typical": q.typical,
                "of": b.of,
                "side": b.side,
                "bound": b.value,
                "proportion": b.proportion,
                "confidence": b.confidence,
            }
            for q in self.quantities
            for b in q.bounds
        ]
        return frame(rows, library)

    def __repr__(self) -> str:
        return f"<DataSheet: {self.units} units of {self.lots} lots, {len(self.quantities)} quantities>"

    def _repr_html_(self) -> str:
        rows = [
            (q.id, q.channel, q.unit, q.typical, b.of, b.side, b.value)
            for q in self.quantities
            for b in q.bounds
        ]
        heads = ("quantity", "channel", "unit", "typical", "bound of", "side", "bound")
        return _table(heads, rows) + self._drawn()


def _quantity(record: dict[str, Any]) -> SheetQuantity:
    typical = record.get("typical")
    interval = None if typical is None else typical.get("interval")
    return SheetQuantity(
        id=record["id"],
        channel=record["channel"],
        unit=record["unit"],
        units=record["units"],
        typical=None if typical is None else typical["value"],
        interval=None if interval is None else (interval["low"], interval["high"]),
        level=None if interval is None else interval["coverage"],
        bounds=tuple(
            SheetBound(
                of=b["of"],
                side=b["side"],
                value=b["value"],
                proportion=b["proportion"],
                confidence=b["confidence"],
            )
            for b in record["bounds"]
        ),
    )


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Plan(Result):
    """The next test, which tells the explanations of a recording apart: the result of :func:`plan`.

    Attributes:
        outcome: ``decides``, ``too_short``, ``undecidable`` or ``nothing_to_decide``.
        schedule: The schedule as the text of a TOML file, or ``None`` where there is nothing to do.
    """

    outcome: str
    schedule: str | None

    @classmethod
    def _of(cls, native: _native.Results, schedule: str | None) -> Plan:
        return cls(_native=native, outcome=json.loads(native.json())["outcome"], schedule=schedule)

    def __repr__(self) -> str:
        return f"<Plan: {self.outcome}>"

    def _repr_html_(self) -> str:
        text = html.escape(self.schedule or "")
        return f"<p><b>{html.escape(self.outcome)}</b></p><pre>{text}</pre>{self._drawn()}"


@dataclass(frozen=True, slots=True, repr=False)
class Inspection:
    """What a recording holds: the result of :func:`inspect`.

    Attributes:
        text: Columns, time base, faults, and which tests the recording supports, in words.
        columns: The columns in the order of the file.
    """

    text: str
    columns: tuple[Column, ...]

    @classmethod
    def _of(cls, text: str, columns: str) -> Inspection:
        found = tuple(
            Column(name=c["name"], numeric=c["numeric"], role=c["role"], unit=c["unit"])
            for c in json.loads(columns)
        )
        return cls(text=text, columns=found)

    def to_dict(self) -> dict[str, Any]:
        """Returns the text and the columns."""
        return {
            "text": self.text,
            "columns": [
                {"name": c.name, "numeric": c.numeric, "role": c.role, "unit": c.unit}
                for c in self.columns
            ],
        }

    def to_frame(self, library: str | None = None) -> Any:
        """Returns the columns as a DataFrame of ``pandas`` or ``polars``, one row each."""
        return frame(self.to_dict()["columns"], library)

    def __str__(self) -> str:
        return self.text

    def __repr__(self) -> str:
        return f"<Inspection: {', '.join(c.name for c in self.columns)}>"

    def _repr_html_(self) -> str:
        return f"<pre>{html.escape(self.text)}</pre>"


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Simulation:
    """A recording made from a model: the result of :func:`simulate`.

    Attributes:
        columns: Arrays of equal length by name: ``time_s``, ``rate_deg_h``, and the columns that the model drives.
        seed: Seed that it was made with; the same gives the same recording.
    """

    columns: dict[str, npt.NDArray[np.float64]]
    seed: int

    @property
    def time_s(self) -> npt.NDArray[np.float64]:
        """Times, s."""
        return self.columns["time_s"]

    @property
    def rate_deg_h(self) -> npt.NDArray[np.float64]:
        """Output of the gyro, deg/h."""
        return self.columns["rate_deg_h"]

    def __getitem__(self, name: str) -> npt.NDArray[np.float64]:
        return self.columns[name]

    def __len__(self) -> int:
        return len(self.time_s)

    def to_dict(self) -> dict[str, npt.NDArray[np.float64]]:
        """Returns the columns by name."""
        return dict(self.columns)

    def plot(self, ax: Any = None, column: str = "rate_deg_h") -> Any:
        """Draws a column over time; returns the axes of matplotlib.

        Raises:
            KeyError: There is no such column.
        """
        return _plots.course(self.time_s, self.columns[column], column, ax)

    def to_frame(self, library: str | None = None) -> Any:
        """Returns the recording as a DataFrame of ``pandas`` or ``polars``."""
        if library not in (None, "pandas", "polars"):
            raise ArgumentError(f"library: pandas or polars, not {library}")
        made = frame([], library)
        return type(made)(dict(self.columns))

    def __repr__(self) -> str:
        return f"<Simulation: {len(self)} rows of {', '.join(self.columns)}, seed {self.seed}>"
