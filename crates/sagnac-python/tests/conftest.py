"""Paths that tests share. Samples are synthetic and part of the repository."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]


@pytest.fixture
def root() -> Path:
    """The repository."""
    return ROOT


@pytest.fixture
def samples() -> Path:
    """The sample recordings."""
    return ROOT / "samples"


@pytest.fixture
def procedures() -> Path:
    """The procedures."""
    return ROOT / "procedures"


@pytest.fixture
def program() -> str:
    """The program, as the same build made it: ``SAGNAC_PROGRAM``, else that of the release build."""
    given = os.environ.get("SAGNAC_PROGRAM")
    target = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
    found = Path(given) if given else target / "release" / "sagnac"
    if not found.is_file():
        pytest.skip(f"no program at {found}: build it with `cargo build --release`, or set SAGNAC_PROGRAM")
    return str(found)
