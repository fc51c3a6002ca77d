"""Rows as a DataFrame of whichever library is installed."""

from __future__ import annotations

import importlib
from collections.abc import Sequence
from typing import Any

from ._errors import ArgumentError


def frame(rows: Sequence[dict[str, Any]], library: str | None) -> Any:
    """Makes a DataFrame of rows: of pandas or polars as asked for, else of the first of them that is installed."""
    wanted = ("pandas", "polars") if library is None else (library,)
    for name in wanted:
        if name not in ("pandas", "polars"):
            raise ArgumentError(f"library: pandas or polars, not {name}")
        try:
            module = importlib.import_module(name)
        except ImportError:
            continue
        if name == "polars":
            return module.DataFrame(list(rows), infer_schema_length=None)
        return module.DataFrame(list(rows))
    raise ImportError(f"a DataFrame needs {' or '.join(wanted)}; install one of them")
