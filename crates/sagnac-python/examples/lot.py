"""Tests every recording of a folder and makes a data sheet of the units.

    python lot.py FOLDER OUT
"""

from __future__ import annotations

import sys
from pathlib import Path

import sagnac


def tested(path: Path) -> sagnac.RunResult | None:
    """Runs the static test on a recording; ``None``, and a sentence, where that is not possible."""
    try:
        return sagnac.run("static-bias", path, limits="sample-unit")
    except sagnac.SagnacError as error:
        print(f"{path.name}: {error}", file=sys.stderr)
        return None


def main(folder: Path, out: Path) -> sagnac.DataSheet:
    """Writes a report for each recording, and the data sheet of all."""
    results: list[sagnac.RunResult] = []
    for path in sorted(folder.glob("unit-*.csv")):
        result = tested(path)
        if result is None:
            continue
        n = result["angle_random_walk"]
        low, high = n.interval if n.interval is not None else (float("nan"), float("nan"))
        print(f"{path.name}: {result.verdict}, N = {n.value} ({low} … {high}) {n.unit}")
        result.write(out / path.stem)
        results.append(result)
    sheet = sagnac.datasheet(results)
    sheet.write(out / "sheet")
    return sheet


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
