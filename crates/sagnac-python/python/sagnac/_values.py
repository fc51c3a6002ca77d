"""Small frozen objects that results are made of."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

Interval = tuple[float, float]
"""Lower and upper end; the level stands beside it."""


@dataclass(frozen=True, slots=True)
class Bound:
    """A one-sided bound of a quantity that the recording does not resolve.

    Attributes:
        value: The bound, in the unit of the quantity.
        level: Confidence in it, for example 0.95.
    """

    value: float
    level: float


@dataclass(frozen=True, slots=True)
class Limit:
    """A limit as it was applied.

    Attributes:
        min: Lower limit, or ``None``.
        max: Upper limit, or ``None``.
        unit: Unit of both.
        rule: Decision rule, for example ``guard_band``.
        acceptance_min: Smallest measured value that passes.
        acceptance_max: Largest measured value that passes.
    """

    min: float | None
    max: float | None
    unit: str
    rule: str
    acceptance_min: float | None
    acceptance_max: float | None


@dataclass(frozen=True, slots=True)
class Measurand:
    """A measured quantity.

    Attributes:
        id: Its id, for example ``angle_random_walk``.
        channel: Channel that it is of.
        phase: Phase of the test, where there are several.
        value: Estimate, or ``None`` where the recording does not show it.
        unit: Unit of the value.
        interval: (low, high) at ``level``, or ``None``.
        level: Coverage of the interval, or ``None``.
        identifiable: Whether the recording shows the quantity.
        upper_limit: Upper bound where it does not.
        lower_limit: Lower bound where it does not, and where there is one.
        method: How it was obtained.
        limit: The limit that it was judged by.
        verdict: ``pass``, ``fail``, ``indeterminate``, ``error`` or ``none``.
        margin: Distance to the nearest limit, positive inside.
        notes: What must be known with the value, in English.
    """

    id: str
    channel: str
    phase: str | None
    value: float | None
    unit: str
    interval: Interval | None
    level: float | None
    identifiable: bool
    upper_limit: Bound | None
    lower_limit: Bound | None
    method: str
    limit: Limit | None
    verdict: str
    margin: float | None
    notes: tuple[str, ...]

    def to_dict(self) -> dict[str, Any]:
        """Returns the fields as a dictionary."""
        return asdict(self)

    def __str__(self) -> str:
        if self.value is None:
            if self.upper_limit is None:
                return f"{self.id} ({self.channel}): not identifiable"
            bound = self.upper_limit
            return f"{self.id} ({self.channel}): < {bound.value:.4g} {self.unit} ({100 * bound.level:g} %)"
        text = f"{self.id} ({self.channel}): {self.value:.6g} {self.unit}"
        if self.interval is not None and self.level is not None:
            low, high = self.interval
            text += f" ({100 * self.level:g} %: {low:.6g} … {high:.6g})"
        return text


def measurand(record: Mapping[str, Any]) -> Measurand:
    """Makes the object of a measurand in a record."""
    interval = record["interval"]
    limit = record["limit"]
    return Measurand(
        id=record["id"],
        channel=record["channel"],
        phase=record.get("phase"),
        value=record["value"],
        unit=record["unit"],
        interval=None if interval is None else (interval["low"], interval["high"]),
        level=None if interval is None else interval["coverage"],
        identifiable=record["identifiable"],
        upper_limit=_bound(record["upper_limit"]),
        lower_limit=_bound(record.get("lower_limit")),
        method=record["method"],
        limit=None
        if limit is None
        else Limit(
            min=limit["min"],
            max=limit["max"],
            unit=limit["unit"],
            rule=limit["rule"],
            acceptance_min=limit["acceptance_min"],
            acceptance_max=limit["acceptance_max"],
        ),
        verdict=record["verdict"],
        margin=record["margin"],
        notes=tuple(note["text"] for note in record["notes"]),
    )


def _bound(record: Mapping[str, Any] | None) -> Bound | None:
    return None if record is None else Bound(value=record["value"], level=record["coverage"])


@dataclass(frozen=True, slots=True)
class Condition:
    """A condition of the test.

    Attributes:
        id: Its id, for example ``temperature``.
        status: ``ok``, ``remark``, ``invalid`` or what else the procedure knows.
        required: What was required.
        observed: What was observed, by name.
        note: What is to be known.
    """

    id: str
    status: str
    required: str | None
    observed: Any
    note: str | None


@dataclass(frozen=True, slots=True)
class Line:
    """A spectral line.

    Attributes:
        frequency_hz: Its frequency, Hz.
        amplitude_deg_h: Its amplitude, deg/h.
    """

    frequency_hz: float
    amplitude_deg_h: float


@dataclass(frozen=True, slots=True, eq=False)
class AllanCurve:
    """A deviation of the Allan family over averaging times. All arrays have one element for each averaging time.

    Attributes:
        estimator: ``oadev``, ``mdev``, ``hdev`` or ``totdev``.
        tau_s: Averaging times, s.
        deviation: Deviations, in the unit of the samples.
        low: Lower ends of the intervals; NaN where there is none.
        high: Upper ends.
        level: Coverage of the intervals, 0.95.
        edf: Equivalent degrees of freedom of the variances.
        terms: Numbers of terms that were summed.
        stride: Steps between summed terms, in samples; 1: every overlapping term.
        noise: Noise that the intervals are for, at each averaging time.
    """

    estimator: str
    tau_s: npt.NDArray[np.float64]
    deviation: npt.NDArray[np.float64]
    low: npt.NDArray[np.float64]
    high: npt.NDArray[np.float64]
    level: float
    edf: npt.NDArray[np.float64]
    terms: npt.NDArray[np.int64]
    stride: npt.NDArray[np.int64]
    noise: tuple[str, ...]

    @property
    def intervals(self) -> tuple[Interval, ...]:
        """(low, high) of each averaging time."""
        return tuple(zip(self.low.tolist(), self.high.tolist(), strict=True))

    def __len__(self) -> int:
        return len(self.tau_s)

    def __iter__(self) -> Iterator[tuple[float, float, Interval]]:
        """Yields averaging time, deviation and (low, high)."""
        return zip(self.tau_s.tolist(), self.deviation.tolist(), self.intervals, strict=True)

    def to_dict(self) -> dict[str, Any]:
        """Returns columns as lists: ``estimator``, ``tau_s``, ``deviation``, ``low``, ``high``, ``edf``, ``terms``, ``stride``, ``noise``."""
        return {
            "estimator": [self.estimator] * len(self),
            "tau_s": self.tau_s.tolist(),
            "deviation": self.deviation.tolist(),
            "low": self.low.tolist(),
            "high": self.high.tolist(),
            "edf": self.edf.tolist(),
            "terms": self.terms.tolist(),
            "stride": self.stride.tolist(),
            "noise": list(self.noise),
        }


def allan_curve(estimator: str, points: list[dict[str, Any]]) -> AllanCurve:
    """Makes the curve of points of the compiled part."""

    def numbers(key: str) -> npt.NDArray[np.float64]:
        return _frozen(np.array([np.nan if p[key] is None else p[key] for p in points], dtype=np.float64))

    def counts(key: str) -> npt.NDArray[np.int64]:
        return _frozen(np.array([p[key] for p in points], dtype=np.int64))

    return AllanCurve(
        estimator=estimator,
        tau_s=numbers("tau_s"),
        deviation=numbers("deviation"),
        low=numbers("low"),
        high=numbers("high"),
        level=0.95,
        edf=numbers("edf"),
        terms=counts("terms"),
        stride=counts("stride"),
        noise=tuple(p["noise"] for p in points),
    )


def _frozen(array: npt.NDArray[Any]) -> npt.NDArray[Any]:
    array.flags.writeable = False
    return array


@dataclass(frozen=True, slots=True)
class Column:
    """A column of a recording.

    Attributes:
        name: Name in the file.
        numeric: Whether numbers can be read from it.
        role: What it is taken for, from its name.
        unit: Its unit, where the name or the format tells it.
    """

    name: str
    numeric: bool
    role: str
    unit: str | None


@dataclass(frozen=True, slots=True)
class Figure:
    """A figure of a report.

    Attributes:
        id: Its id, for example ``sigma_tau``.
        file: Name of its file in a folder of results.
        svg: The drawing.
    """

    id: str
    file: str
    svg: str

    def _repr_svg_(self) -> str:
        return self.svg
