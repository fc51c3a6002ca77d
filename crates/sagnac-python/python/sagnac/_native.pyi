"""The compiled part. Use the functions of :mod:`sagnac` instead."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

__version__: str

_Progress = Callable[[str, float], object] | None
_Document = str | tuple[str, str]

class _Array:
    def __array__(self, dtype: Any = None, copy: Any = None) -> npt.NDArray[np.float64]: ...

class Results:
    @staticmethod
    def open(path: str) -> Results: ...
    def record_file(self) -> str: ...
    def json(self) -> str: ...
    def figures(self, lang: str) -> list[tuple[str, str, str]]: ...
    def tables(self) -> list[tuple[str, str]]: ...
    def write(self, folder: str, forms: Sequence[str], lang: str) -> None: ...

def toml_text(tables: str) -> str: ...
def main(arguments: Sequence[str], executable: str) -> int: ...
def allan(
    rate: object,
    tau0_s: float,
    taus: str | list[float],
    estimators: list[str],
    exact: bool,
    progress: _Progress,
) -> tuple[str, str]: ...
def identify(
    rate: object, tau0_s: float, unit: str, progress: _Progress
) -> tuple[str, list[tuple[str, str, str]]]: ...
def inspect(
    source: object, sample_rate_hz: float | None, lang: str, progress: _Progress
) -> tuple[str, str]: ...
def analyze(
    source: object,
    sample_rate_hz: float | None,
    columns: dict[str, Any],
    taus: str | list[float],
    exact: bool,
    progress: _Progress,
) -> Results: ...
def run(
    procedure: _Document,
    source: object,
    limits: _Document | None,
    session: dict[str, str | None],
    progress: _Progress,
) -> tuple[Results, list[str]]: ...
def explain(
    source: object, model: _Document, alpha: float, max_effects: int, progress: _Progress
) -> tuple[Results, _Array | None, _Array | None]: ...
def simulate(
    model: _Document, seed: int | None, duration_s: float | None, progress: _Progress
) -> tuple[list[tuple[str, _Array]], int]: ...
def compare(units: list[tuple[Results, str, str, bool]]) -> Results: ...
def datasheet(
    results: list[str | tuple[Results, str]], proportion: float, confidence: float
) -> Results: ...
