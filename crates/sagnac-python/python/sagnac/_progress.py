"""Progress of long work: a function of the user, or a bar."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, TypeAlias

Progress: TypeAlias = "bool | Callable[[str, float], object]"
"""True for a bar (tqdm where it is installed), or a function that gets what is being done and a share from 0 to 1."""


@contextmanager
def watching(progress: Progress) -> Iterator[Callable[[str, float], object] | None]:
    """Gives the function that the compiled part calls, and closes the bar in the end."""
    if callable(progress):
        yield progress
        return
    if not progress:
        yield None
        return
    try:
        from tqdm.auto import tqdm
    except ImportError:
        yield _line
        print(file=sys.stderr)
        return
    bar: Any = tqdm(total=1.0, bar_format="{desc} {percentage:3.0f}%|{bar}| {elapsed}<{remaining}")

    def tell(doing: str, share: float) -> None:
        bar.set_description(doing, refresh=False)
        bar.n = share
        bar.refresh()

    try:
        yield tell
    finally:
        bar.close()


def _line(doing: str, share: float) -> None:
    print(f"\r{doing} {100 * share:3.0f} %", end="", file=sys.stderr, flush=True)
