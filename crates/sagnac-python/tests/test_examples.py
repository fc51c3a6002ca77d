"""The examples run, and what they show is right."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"


def test_the_notebook_runs(tmp_path: Path, root: Path) -> None:
    nbclient = pytest.importorskip("nbclient")
    nbformat = pytest.importorskip("nbformat")
    pytest.importorskip("allantools")
    notebook: Any = nbformat.read(EXAMPLES / "allantools_users_day.ipynb", as_version=4)
    client = nbclient.NotebookClient(notebook, resources={"metadata": {"path": str(root)}})
    client.execute()
    shown = [
        output["data"]["text/html"]
        for cell in notebook.cells
        for output in cell.get("outputs", [])
        if "text/html" in output.get("data", {})
    ]
    # Inspection, curve, terms, report and frame; three of them with drawings.
    assert len(shown) == 5 and sum("<svg" in page for page in shown) == 3


def test_the_example_of_a_lot_runs(samples: Path, tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, str(EXAMPLES / "lot.py"), str(samples), str(tmp_path)],
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    assert "unit-fail.csv: fail" in done.stdout
    assert (tmp_path / "sheet" / "datasheet.json").is_file()
    assert (tmp_path / "unit-pass" / "report.html").is_file()
