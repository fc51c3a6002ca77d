"""Coverage of the 95 % intervals of ``sagnac.allan``, whose noise is read from the slope: 1500 records of 4096 samples a case.

    python interval_coverage.py

The truth is the root mean square of the deviations of all records, so that no formula is shared with the intervals.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

import sagnac

SAMPLES, RECORDS, POINTS = 4096, 1500, 11

Array = npt.NDArray[np.float64]


def flicker(rng: np.random.Generator) -> Array:
    """Noise of a spectrum 1/f, cut from a record eight times as long."""
    long = 8 * SAMPLES
    frequency = np.fft.rfftfreq(long)
    frequency[0] = frequency[1]
    modes = rng.normal(size=len(frequency)) + 1j * rng.normal(size=len(frequency))
    modes *= frequency**-0.5
    modes[0] = 0
    return np.asarray(np.fft.irfft(modes)[:SAMPLES], dtype=np.float64)


CASES: dict[str, Callable[[np.random.Generator], Array]] = {
    "white": lambda rng: rng.normal(size=SAMPLES),
    "random walk": lambda rng: np.cumsum(rng.normal(size=SAMPLES)),
    "flicker": flicker,
    "white and walk": lambda rng: 30 * rng.normal(size=SAMPLES) + np.cumsum(rng.normal(size=SAMPLES)),
}


def main() -> None:
    """Prints the share of records whose interval holds the truth, for each octave."""
    rng = np.random.default_rng(3)
    for name, made in CASES.items():
        curves = [sagnac.allan(made(rng), 1.0)["oadev"] for _ in range(RECORDS)]
        truth = np.sqrt(np.mean([c.deviation[:POINTS] ** 2 for c in curves], axis=0))
        held = [(c.low[:POINTS] <= truth) & (truth <= c.high[:POINTS]) for c in curves]
        print(name, np.round(np.mean(held, axis=0), 3))


if __name__ == "__main__":
    main()
