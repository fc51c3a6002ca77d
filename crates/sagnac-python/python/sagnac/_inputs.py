"""What functions accept: samples and recordings, handed to the compiled part without a copy where that is possible."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import Any, Protocol, TypeAlias, runtime_checkable

import numpy as np
import numpy.typing as npt

from ._errors import ArgumentError


@runtime_checkable
class ArrowArray(Protocol):
    """An array that hands its memory over by the Arrow PyCapsule interface."""

    def __arrow_c_array__(self, requested_schema: object | None = None) -> tuple[object, object]: ...


@runtime_checkable
class ArrowStream(Protocol):
    """A series, chunked array or table that hands its memory over by the Arrow PyCapsule interface."""

    def __arrow_c_stream__(self, requested_schema: object | None = None) -> object: ...


Samples: TypeAlias = "npt.NDArray[Any] | ArrowArray | ArrowStream | Sequence[float]"
"""Numbers of one column: a numpy array, any Arrow array or series (polars, pyarrow, pandas), or a sequence."""

Path: TypeAlias = "str | os.PathLike[str]"
"""A path."""

Source: TypeAlias = "Path | Sequence[Path] | Mapping[str, Samples] | ArrowStream"
"""A recording: a path, the paths of its files in order, columns by name, or a DataFrame."""


def samples(values: Samples, name: str = "rate") -> object:
    """Returns one column of numbers as the compiled part takes it.

    Arrow arrays and contiguous numpy arrays are passed on as they are; anything else is copied once.
    """
    if isinstance(values, (ArrowArray, ArrowStream)) and not _of_pandas(values):
        return values
    array = np.asarray(values)
    if array.ndim != 1:
        raise ArgumentError(f"{name}: one dimension is expected, not {array.ndim} (shape {array.shape})")
    if array.dtype.kind == "M":
        array = array.astype("datetime64[ns]").astype(np.int64) / 1e9
    if array.dtype.kind not in "fiu" or array.dtype.itemsize > 8:
        raise ArgumentError(f"{name}: numbers are expected, not {array.dtype}")
    if array.dtype == np.float16 or not array.dtype.isnative:
        array = array.astype(np.float64)
    return np.ascontiguousarray(array)


def source(recording: Source) -> object:
    """Returns a recording as the compiled part takes it."""
    if isinstance(recording, (str, os.PathLike)):
        return os.fspath(recording)
    if isinstance(recording, Mapping):
        return {str(name): samples(values, str(name)) for name, values in recording.items()}
    if _of_pandas(recording):
        return _numbers_of(recording)
    if isinstance(recording, ArrowStream):
        return recording
    paths: list[str] = []
    for path in recording:
        if not isinstance(path, (str, os.PathLike)):
            raise ArgumentError(
                "recording: a path, paths, columns by name or a DataFrame are expected, "
                f"not a sequence of {type(path).__name__}"
            )
        paths.append(os.fspath(path))
    return paths


def _of_pandas(values: object) -> bool:
    """True for an object of pandas, which hands its memory over by Arrow only where pyarrow is installed."""
    return type(values).__module__.partition(".")[0] == "pandas"


def _numbers_of(table: Any) -> dict[str, object]:
    """Returns the columns of a DataFrame of pandas that hold numbers or times; others are left out, as those of any table."""
    columns: dict[str, object] = {}
    for place, name in enumerate(table.columns):
        column = table.iloc[:, place]
        kind = getattr(column.dtype, "kind", "O")
        if kind in "fiu":
            columns[str(name)] = samples(column.to_numpy(dtype=np.float64, na_value=np.nan), str(name))
        elif kind == "M":
            columns[str(name)] = samples(column.to_numpy(dtype="datetime64[ns]"), str(name))
    return columns


def seconds(taus: str | Sequence[float] | npt.NDArray[Any]) -> str | list[float]:
    """Returns averaging times as the compiled part takes them: a word, or seconds."""
    return taus if isinstance(taus, str) else [float(tau) for tau in taus]
