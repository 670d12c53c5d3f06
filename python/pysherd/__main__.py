"""The program ``sherd``, which the package holds: ``python -m pysherd`` and the command ``sherd``."""

import importlib.util
import os
import pathlib
import sys


def _hdf5_library() -> str | None:
    """The HDF5 library inside h5py's wheel, where that is installed: the machine needs none of its own then."""
    found = importlib.util.find_spec("h5py")
    if found is None or found.origin is None:
        return None
    inside = pathlib.Path(found.origin).parent.with_name("h5py.libs")
    return next((str(path) for path in sorted(inside.glob("libhdf5-*.so*"))), None)


def main() -> None:
    """Becomes the program, with the arguments of this process."""
    program = pathlib.Path(__file__).with_name("bin") / "sherd"
    library = _hdf5_library()
    if library is not None:
        os.environ.setdefault("SHERD_HDF5_LIBRARY", library)
    os.execv(program, ["sherd", *sys.argv[1:]])


if __name__ == "__main__":
    main()
