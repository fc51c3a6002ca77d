"""The code in the guide runs as it stands."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]
GUIDE = ROOT / "docs" / "guide"


def code(page: str) -> str:
    """Joins the Python blocks of a page."""
    blocks = re.findall(r"^```python\n(.*?)^```$", (GUIDE / page).read_text(), re.DOTALL | re.MULTILINE)
    assert blocks
    return "\n".join(blocks)


def ran(page: str, folder: Path, check: str = "") -> str:
    """Runs a page in a folder that has samples and procedures, and returns what it prints."""
    for name in ("samples", "procedures"):
        (folder / name).symlink_to(ROOT / name)
    done = subprocess.run(
        [sys.executable, "-c", code(page) + "\n" + check],
        cwd=folder,
        capture_output=True,
        text=True,
        env={**os.environ, "RAY_ACCEL_ENV_VAR_OVERRIDE_ON_ZERO": "0", "PYSPARK_PYTHON": sys.executable},
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_the_page_of_the_package(tmp_path: Path) -> None:
    pytest.importorskip("pandas")
    printed = ran("python.md", tmp_path)
    assert "did you mean `angle_random_walk`" in printed and "bias_step" in printed
    assert (tmp_path / "report" / "report.html").is_file()


def test_the_page_of_spark(tmp_path: Path) -> None:
    pytest.importorskip("pyspark")
    check = (
        "assert list(results['error'].isna()) == [p != 'none.csv' for p in results.index], results\n"
        "import sagnac\n"
        "here = sagnac.run('procedures/static-bias.toml', paths[0], serial='SN-0001')\n"
        "assert results.loc[paths[0], 'n_deg_rt_h'] == here['angle_random_walk'].value\n"
    )
    assert "none.csv" in ran("python-spark.md", tmp_path, check)


def test_the_page_of_ray(tmp_path: Path) -> None:
    pytest.importorskip("ray")
    check = (
        "assert results['none.csv']['error'] and not results[paths[0]]['error'], results\n"
        "import sagnac\n"
        "here = sagnac.run('procedures/static-bias.toml', paths[0], serial='SN-0001')\n"
        "assert results[paths[0]]['n_deg_rt_h'] == here['angle_random_walk'].value\n"
    )
    assert "none.csv" in ran("python-ray.md", tmp_path, check)
