"""The program, as ``sagnac`` or ``python -m sagnac``."""

from __future__ import annotations

import sys

from . import _native
from ._program import program


def main() -> None:
    """Runs the program on the arguments of the process, and exits with its code."""
    sys.exit(_native.main(["sagnac", *sys.argv[1:]], program()))


if __name__ == "__main__":
    main()
