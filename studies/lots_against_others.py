"""Data sheets of random lots against programs of others.

Needs Python with numpy, scipy, toleranceinterval, statsmodels and surpyval, R with lme4, and `sagnac` as first argument:

    python studies/lots_against_others.py target/release/sagnac

Prints one line a comparison, for docs/validation/lots.md; exit code 1 where an exact one does not hold.
"""

import json
import pathlib
import subprocess
import sys
import tempfile

import numpy as np
import surpyval
import toleranceinterval.oneside as oneside
from statsmodels.stats.diagnostic import normal_ad
from statsmodels.stats.meta_analysis import combine_effects

LOTS = 20
EXACT = 1e-6
COVERAGE_95 = 1.959963984540054


def result(serial, lot, log_value, deviation, limit):
    """A result of one quantity; with a limit it is only bounded."""
    low, high = np.exp(log_value - COVERAGE_95 * deviation), np.exp(log_value + COVERAGE_95 * deviation)
    told = {"value": float(np.exp(log_value)), "interval": {"low": float(low), "high": float(high), "coverage": 0.95}}
    if limit is not None:
        told = {"value": None, "identifiable": False, "upper_limit": {"value": float(np.exp(limit)), "coverage": 0.95}}
    return {
        "format": "result/1",
        "procedure": {"id": "static-bias", "revision": "A"},
        "unit_under_test": {"serial": serial, "model": "A-1", "lot": lot},
        "verdict": "pass",
        "measurands": [{"id": "angle_random_walk", "channel": "rate", "unit": "deg/sqrt(h)", **told}],
    }


def sheet(program, units):
    """The quantity of a data sheet of units (lot, logarithm, standard uncertainty, limit of detection)."""
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        files = []
        for i, (lot, log_value, deviation, limit) in enumerate(units):
            file = folder / f"{i}.json"
            file.write_text(json.dumps(result(f"SN-{i}", lot, log_value, deviation, limit)))
            files.append(str(file))
        command = [program, "datasheet", *files, "--out", str(folder / "out"), "--quiet"]
        subprocess.run(command, check=True, capture_output=True)
        return json.loads((folder / "out" / "datasheet.json").read_text())["quantities"][0]


def bound(quantity, of):
    """The logarithm of the upper bound."""
    return next(np.log(b["value"]) for b in quantity["bounds"] if b["of"] == of and b["side"] == "upper")


def reml(values, lots):
    """Standard deviations between lots and within them, by lme4."""
    rows = "\n".join(f"{v!r},{lot}" for v, lot in zip(values, lots))
    code = (
        "suppressMessages(library(lme4)); d <- read.csv(file('stdin'), header = FALSE);"
        "m <- suppressMessages(lmer(V1 ~ 1 + (1 | V2), data = d));"
        "cat(as.data.frame(VarCorr(m))$sdcor)"
    )
    said = subprocess.run(["Rscript", "-e", code], input=rows, check=True, capture_output=True, text=True)
    return [float(x) for x in said.stdout.split()]


def main():
    program = sys.argv[1]
    rng = np.random.default_rng(20261126)
    failed = False

    for n in (10, 30, 100):
        off = []
        for _ in range(LOTS):
            x = rng.normal(-6.0, 0.1, n)
            quantity = sheet(program, [("1", v, 1e-7, None) for v in x])
            if quantity["bounds"][0]["method"] == "exact_normal":
                off.append(abs(bound(quantity, "true") - oneside.normal(x, 0.95, 0.95)[0]) / x.std(ddof=1))
        failed |= max(off) > EXACT
        print(f"bound 95/95 of {n} exact values, toleranceinterval: largest difference {max(off):.1e} spreads, {len(off)} lots")

    off = []
    for _ in range(LOTS):
        x = rng.normal(-6.0, 0.1, 25)
        quantity = sheet(program, [("1", v, 1e-7, None) for v in x])
        off.append(abs(quantity["normality"] - normal_ad(x)[1]))
    failed |= max(off) > 1e-3
    print(f"Anderson-Darling of 25 values, statsmodels: largest difference of p {max(off):.1e}, {LOTS} lots")

    ratios = []
    for _ in range(LOTS):
        u = rng.uniform(0.02, 0.08, 40)
        x = rng.normal(-6.0, 0.1, 40) + u * rng.normal(size=40)
        quantity = sheet(program, list(zip(["1"] * 40, x, u, [None] * 40)))
        paule_mandel = np.sqrt(combine_effects(x, u**2, method_re="iterated").tau2)
        ratios.append(quantity["spread"]["between_units"] / paule_mandel)
    print(f"spread of 40 units of unequal uncertainty over Paule and Mandel's, statsmodels: {np.median(ratios):.3f} "
          f"({min(ratios):.3f} to {max(ratios):.3f})")

    units, lots = [], []
    for _ in range(LOTS):
        names = [str(i % 6) for i in range(60)]
        shift = rng.normal(0.0, 0.1, 6)
        x = np.array([rng.normal(-6.0, 0.1) + shift[int(lot)] for lot in names])
        quantity = sheet(program, [(lot, v, 1e-7, None) for lot, v in zip(names, x)])
        between, within = reml(list(map(float, x)), names)
        units.append(quantity["spread"]["between_units"] / within)
        lots.append(quantity["spread"]["between_lots"] / between)
    print(f"spread of 60 units in 6 lots over that of lme4: {np.median(units):.3f} ({min(units):.3f} to {max(units):.3f})")
    print(f"spread between 6 lots over that of lme4: {np.median(lots):.3f} ({min(lots):.3f} to {max(lots):.3f})")

    off = []
    for _ in range(LOTS):
        x = np.sort(rng.normal(-6.0, 0.1, 40))
        limit = x[10]
        told = [("1", v, 1e-4, limit if v < limit else None) for v in x]
        quantity = sheet(program, told)
        # A value that is only bounded is censored from the left.
        fit = surpyval.Normal.fit(np.maximum(x, limit), c=np.where(x < limit, -1, 0))
        off.append((np.log(quantity["typical"]["value"]) - fit.params[0]) / (fit.params[1] / np.sqrt(40)))
    print(f"median of 40 units of which 10 are only bounded, from that of surpyval: {np.mean(off):+.2f} standard errors "
          f"({min(off):+.2f} to {max(off):+.2f})")

    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
