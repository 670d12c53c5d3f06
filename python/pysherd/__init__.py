"""Breaks 3D models into fragments.

>>> import pysherd
>>> solid = pysherd.voxelize("bowl.obj", resolution=128)
>>> f = pysherd.fracture(solid, pieces=8, seed=1, roughness=1.0)
>>> f[0].vertices, f[0].faces, f[0].neighbor, f[0].volume, f.contacts, f.labels

Lengths are in the mesh's own unit unless a name says voxels.  Same object, options and seed: same result, that of the program
``sherd``.  Functions may be called from several threads at once.
"""

from . import _pickles  # noqa: F401: what pickle calls
from ._core import limit_threads as _limit_threads
from ._core import version as _version
from ._break import fracture, load
from ._errors import Cancelled, DeviceError, Error, FileError, InputError, OutputError, SherdWarning, UsageError
from ._fracture import Fracture
from ._fragment import Contacts, Fragment, Points, SparseLabels
from ._options import Options
from ._solid import Solid, voxelize
from ._values import whole as _whole

__version__: str = _version()
__all__ = [
    "Cancelled", "Contacts", "DeviceError", "Error", "FileError", "Fracture", "Fragment", "InputError", "Options", "OutputError",
    "Points", "SherdWarning", "Solid", "SparseLabels", "UsageError", "fracture", "limit_threads", "load", "voxelize",
]  # fmt: skip


def limit_threads(most: int) -> None:
    """Limits the threads of each call from now on.

    Parameters
    ----------
    most : int
        At least 1; 0: all cores.  A worker of a data loader takes 1.

    Raises
    ------
    UsageError
        Another number.
    """
    _limit_threads(_whole("most", most, 0, 4096))
