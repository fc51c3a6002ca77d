"""Drawings by matplotlib, where it is installed, for those who want to add to a figure. The figures of reports are SVG."""

from __future__ import annotations

import importlib
from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from ._values import AllanCurve, Interval

_MOST_POINTS = 20_000


def axes(ax: Any = None) -> Any:
    """Returns the axes given, or new ones.

    Raises:
        ImportError: matplotlib is not installed.
    """
    if ax is not None:
        return ax
    try:
        pyplot = importlib.import_module("matplotlib.pyplot")
    except ImportError as error:
        raise ImportError("plot() needs matplotlib; figures() has the figures of the report as SVG") from error
    return pyplot.subplots()[1]


def deviations(curves: Sequence[AllanCurve], unit: str, ax: Any = None) -> Any:
    """Draws deviations over averaging times with their intervals, both axes logarithmic."""
    ax = axes(ax)
    for curve in curves:
        known = np.isfinite(curve.low) & np.isfinite(curve.high) & (curve.low > 0.0)
        (line,) = ax.plot(curve.tau_s, curve.deviation, marker="o", markersize=3, label=curve.estimator)
        ax.fill_between(
            curve.tau_s, curve.low, curve.high, where=known, alpha=0.25, color=line.get_color(), linewidth=0
        )
    ax.set(xscale="log", yscale="log", xlabel="averaging time, s", ylabel=f"deviation, {unit}")
    ax.grid(True, which="both", alpha=0.3)
    if len(curves) > 1:
        ax.legend()
    return ax


def course(
    time_s: npt.NDArray[np.float64], values: npt.NDArray[np.float64], label: str, ax: Any = None
) -> Any:
    """Draws a course over time: of a long one the lowest and highest value of equal parts, so that no peak is lost."""
    ax = axes(ax)
    parts = _MOST_POINTS // 2
    if len(values) > _MOST_POINTS:
        length = -(-len(values) // parts)
        starts = np.arange(0, len(values), length)
        low, high = np.minimum.reduceat(values, starts), np.maximum.reduceat(values, starts)
        time_s, values = np.repeat(time_s[starts], 2), np.column_stack((low, high)).ravel()
    ax.plot(time_s / 3600.0, values, linewidth=0.8)
    ax.set(xlabel="time, h", ylabel=label)
    ax.grid(True, alpha=0.3)
    return ax


def estimates(rows: Sequence[tuple[str, float, Interval | None]], label: str, ax: Any = None) -> Any:
    """Draws values with their intervals, one row each, the first on top."""
    ax = axes(ax)
    for place, (_, value, interval) in enumerate(rows):
        span = None if interval is None else [[value - interval[0]], [interval[1] - value]]
        ax.errorbar(value, place, xerr=span, fmt="o", capsize=3)
    ax.set_yticks(range(len(rows)), labels=[name for name, _, _ in rows])
    ax.invert_yaxis()
    ax.set_xlabel(label)
    ax.grid(True, axis="x", alpha=0.3)
    return ax
