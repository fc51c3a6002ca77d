"""Sagnac: analysis and acceptance tests of precision gyroscopes.

>>> import numpy as np, sagnac
>>> rate = np.random.default_rng(1).normal(scale=0.6, size=36_000)   # deg/h, one sample a second
>>> noise = sagnac.identify(rate, tau0=1.0)
>>> low, high = noise["angle_random_walk"].interval
>>> low < 0.01 < high                                                # deg/sqrt(h)
True
"""

from ._api import allan, analyze, compare, datasheet, explain, identify, inspect, read, run, simulate
from ._documents import Limits, Model, Procedure
from ._errors import (
    ArgumentError,
    ConfigurationError,
    NotEvaluableError,
    OutputError,
    RecordingError,
    SagnacError,
)
from ._inputs import Samples, Source
from ._measurand import Context, Estimate, Unresolved, measurand, measurand_main
from ._native import __version__
from ._program import Check, Verification, plan, verify, watch
from ._results import (
    Comparison,
    DataSheet,
    Deviations,
    Effect,
    Explanation,
    Inspection,
    Noise,
    Parameter,
    Plan,
    Result,
    RunResult,
    SheetBound,
    SheetQuantity,
    Simulation,
)
from ._values import AllanCurve, Bound, Column, Condition, Figure, Interval, Limit, Line, Measurand

__all__ = [
    "AllanCurve",
    "ArgumentError",
    "Bound",
    "Check",
    "Column",
    "Comparison",
    "Condition",
    "ConfigurationError",
    "Context",
    "DataSheet",
    "Deviations",
    "Effect",
    "Estimate",
    "Explanation",
    "Figure",
    "Inspection",
    "Interval",
    "Limit",
    "Limits",
    "Line",
    "Measurand",
    "Model",
    "Noise",
    "NotEvaluableError",
    "OutputError",
    "Parameter",
    "Plan",
    "Procedure",
    "RecordingError",
    "Result",
    "RunResult",
    "SagnacError",
    "Samples",
    "SheetBound",
    "SheetQuantity",
    "Simulation",
    "Source",
    "Unresolved",
    "Verification",
    "__version__",
    "allan",
    "analyze",
    "compare",
    "datasheet",
    "explain",
    "identify",
    "inspect",
    "measurand",
    "measurand_main",
    "plan",
    "read",
    "run",
    "simulate",
    "verify",
    "watch",
]
