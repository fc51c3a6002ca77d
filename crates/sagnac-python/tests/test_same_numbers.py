"""The package gives the numbers of the program, to the bit, over all samples."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path
from typing import Any

import pytest

import sagnac

ROOT = Path(__file__).resolve().parents[3]
RECORDINGS = sorted((ROOT / "samples").glob("*.csv"))

PROCEDURES = {
    "acceleration": ("acceleration", None),
    "bench-check": ("bench-check", None),
    "bias-repeatability": ("bias-repeatability", None),
    "electromagnetic-immunity": ("electromagnetic-immunity", None),
    "magnetic-sensitivity": ("magnetic-sensitivity", None),
    "maximum-rate": ("maximum-rate", None),
    "misalignment": ("misalignment", None),
    "multi-position": ("multi-position", None),
    "output-noise": ("output-noise", None),
    "pressure-sensitivity": ("pressure-sensitivity", None),
    "scale-factor": ("scale-factor", None),
    "scale-factor-over-temperature": ("scale-factor-over-temperature", None),
    "scale-factor-under-pressure": ("scale-factor-under-pressure", None),
    "start-up": ("start-up", None),
    "supply-sensitivity": ("supply-sensitivity", None),
    "temperature": ("temperature-ramp", "sample-temperature"),
    "temperature-soak": ("temperature-soak", "sample-temperature"),
    "threshold": ("threshold", None),
    "transfer-function": ("transfer-function", None),
    "unit": ("static-bias", "sample-unit"),
    "vibration": ("vibration", None),
    "vibration-by-frequency": ("vibration-by-frequency", None),
    "warm-up": ("warm-up", "sample-warm-up"),
}
"""Procedure and limits of the samples, by the beginning of their names."""

OF_THE_RUN = ("session", "inputs", "files", "figures")
"""Members that tell when and where a result was made, not what was measured."""


def measured(record: dict[str, Any]) -> dict[str, Any]:
    """Leaves out what differs between two runs of the program itself."""
    return {key: value for key, value in record.items() if key not in OF_THE_RUN}


def of_program(program: str, folder: Path, *arguments: str) -> dict[str, Any] | None:
    """Returns the record that the program writes, or ``None`` where it refuses."""
    done = subprocess.run(
        [program, *arguments, "--quiet", "--out", str(folder)], capture_output=True, text=True
    )
    if done.returncode == 2 and not (folder / "result.json").is_file():
        return None
    record: dict[str, Any] = json.loads((folder / "result.json").read_text())
    return record


@pytest.mark.parametrize("recording", RECORDINGS, ids=lambda p: p.stem)
def test_an_analysis_is_that_of_the_program(program: str, recording: Path, tmp_path: Path) -> None:
    expected = of_program(program, tmp_path / "out", "analyze", str(recording))
    if expected is None:
        with pytest.raises(sagnac.SagnacError):
            sagnac.analyze(recording)
        return
    assert measured(sagnac.analyze(recording).to_dict()) == measured(expected)


@pytest.mark.parametrize("recording", RECORDINGS, ids=lambda p: p.stem)
def test_a_run_is_that_of_the_program(
    program: str, procedures: Path, recording: Path, tmp_path: Path
) -> None:
    name = max((n for n in PROCEDURES if recording.stem.startswith(n)), key=len)
    procedure, limits = PROCEDURES[name]
    paths = [str(procedures / f"{procedure}.toml"), str(recording), "--serial", "SN-0001"]
    limits_path = None if limits is None else procedures / "limits" / f"{limits}.toml"
    if limits_path is not None:
        paths += ["--limits", str(limits_path)]
    expected = of_program(program, tmp_path / "out", "run", *paths)
    assert expected is not None
    got = sagnac.run(
        procedures / f"{procedure}.toml", recording, limits=limits_path, serial="SN-0001"
    )
    assert got.verdict == expected["verdict"]
    assert measured(got.to_dict()) == measured(expected)


def test_every_sample_has_its_procedure() -> None:
    assert len(RECORDINGS) > 20
    assert all(any(r.stem.startswith(n) for n in PROCEDURES) for r in RECORDINGS)
