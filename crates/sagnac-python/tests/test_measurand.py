"""Functions of the user that answer the program by the protocol ``measurand/1``."""

from __future__ import annotations

import io
import json
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

import sagnac
from sagnac import _measurand


@pytest.fixture(autouse=True)
def _no_functions() -> Iterator[None]:
    _measurand._registered.clear()
    yield
    _measurand._registered.clear()


def asked(folder: Path, values: list[float]) -> str:
    """A question about one channel."""
    columns = []
    numbers = [("time_s", "s", [float(i) for i in range(len(values))]), ("rate", "deg/h", values)]
    for place, (name, unit, column) in enumerate(numbers):
        file = folder / f"{place}.f64"
        np.array(column, dtype="<f8").tofile(file)
        columns.append({"id": name, "role": "rate", "unit": unit, "file": str(file)})
    return json.dumps(
        {
            "format": "measurand/1",
            "program": "p",
            "version": "1",
            "procedure": {"id": "quick", "revision": "A"},
            "unit": {"serial": "SN-1"},
            "returns": [{"id": "spread", "unit": "deg/h"}],
            "sample_interval_s": 1.0,
            "parquet": "channels.parquet",
            "rows": len(values),
            "columns": columns,
            "scratch": str(folder),
        }
    )


def answered(question: str) -> dict[str, dict[str, object]]:
    out = io.StringIO()
    sagnac.measurand_main(io.StringIO(question + "\n"), out)
    answer = json.loads(out.getvalue())
    assert answer["format"] == "measurand/1"
    assert out.getvalue().count("\n") == 1
    return {estimate["id"]: estimate for estimate in answer["estimates"]}


def test_a_function_is_handed_channels_and_its_estimates_are_answered(tmp_path: Path) -> None:
    @sagnac.measurand
    def spread(columns: _measurand.Columns, context: sagnac.Context) -> dict[str, sagnac.Estimate]:
        print("not a part of the answer")
        assert context.units["rate"] == context.returns["spread"] == "deg/h"
        assert list(columns[context.time_column]) == [0.0, 1.0, 2.0]
        return {"spread": sagnac.Estimate(float(np.ptp(columns["rate"])), "deg/h", interval=(2.5, 3.5))}

    @sagnac.measurand
    def other(columns: _measurand.Columns, context: sagnac.Context) -> dict[str, sagnac.Unresolved]:
        return {"other": sagnac.Unresolved("too short")}

    found = answered(asked(tmp_path, [1.0, 4.0, 2.0]))
    assert found["spread"] == {"id": "spread", "unit": "deg/h", "value": 3.0, "interval": [2.5, 3.5]}
    assert found["other"] == {"id": "other", "unresolved": "too short"}


def test_what_fails_ends_the_process_with_its_reason(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    @sagnac.measurand
    def fails(columns: _measurand.Columns, context: sagnac.Context) -> dict[str, sagnac.Estimate]:
        raise ValueError("no plateau")

    with pytest.raises(SystemExit):
        answered(asked(tmp_path, [1.0]))
    assert capsys.readouterr().err.startswith("ValueError: no plateau")


def test_a_value_that_is_no_number_is_unresolved_and_other_protocols_are_refused(tmp_path: Path) -> None:
    @sagnac.measurand
    def nothing(columns: _measurand.Columns, context: sagnac.Context) -> dict[str, sagnac.Estimate]:
        return {"spread": sagnac.Estimate(float("nan"), "deg/h", standard_uncertainty=1.0)}

    question = asked(tmp_path, [1.0])
    assert answered(question)["spread"] == {"id": "spread", "unresolved": "the value is nan"}
    with pytest.raises(sagnac.ArgumentError, match="measurand/1"):
        answered(question.replace("measurand/1", "measurand/2"))
