"""The program ``sherd``, which the package holds: ``python -m pysherd`` and the command ``sherd``."""

import os
import pathlib
import sys


def main() -> None:
    """Becomes the program, with the arguments of this process."""
    program = pathlib.Path(__file__).with_name("bin") / "sherd"
    os.execv(program, ["sherd", *sys.argv[1:]])


if __name__ == "__main__":
    main()
