# Made by tools/python_stubs.py from the option table.  What is defined below is in quotes: pdoc runs this file.
import os
from typing import Any, Callable, Iterable, Iterator, Literal, Mapping, NamedTuple, Sequence, TypeAlias, overload

import numpy as np
from numpy.typing import NDArray

__version__: str
__all__ = [
    "Cancelled",
    "Contacts",
    "DeviceError",
    "Error",
    "FileError",
    "Fracture",
    "Fragment",
    "InputError",
    "Options",
    "OutputError",
    "Points",
    "SherdWarning",
    "Solid",
    "SparseLabels",
    "UsageError",
    "fracture",
    "limit_threads",
    "load",
    "voxelize",
]

_Path: TypeAlias = str | bytes | os.PathLike[str] | os.PathLike[bytes]
_Progress: TypeAlias = Callable[[str, float], bool | None]

class Error(Exception):
    code: int
    options: tuple[str, ...]
    def __init__(self, sentence: str = "", options: Sequence[str] = ()) -> None: ...

class UsageError(Error, ValueError): ...
class InputError(Error, ValueError): ...
class FileError(Error, OSError): ...
class DeviceError(Error, RuntimeError): ...
class OutputError(Error, OSError): ...
class Cancelled(Error): ...
class SherdWarning(UserWarning): ...

class Options(Mapping[str, Any]):
    def __init__(self, **options: Any) -> None: ...
    def __getitem__(self, keyword: str) -> Any: ...
    def __iter__(self) -> Iterator[str]: ...
    def __len__(self) -> int: ...

class Points(NamedTuple):
    positions: NDArray[np.float64]
    normals: NDArray[np.float64]
    neighbor: NDArray[np.uint16]
    fragment: NDArray[np.uint16]

class Contacts(NamedTuple):
    fragments: NDArray[np.int32]
    area: NDArray[np.float64]
    normal: NDArray[np.float64]
    centroid: NDArray[np.float64]

class SparseLabels(NamedTuple):
    voxels: NDArray[np.int32]
    labels: NDArray[np.uint16]

class Fragment:
    id: int
    def __init__(self, fracture: "Fracture", index: int) -> None: ...
    @property
    def vertices(self) -> NDArray[np.float64]: ...
    @property
    def faces(self) -> NDArray[np.uint32]: ...
    @property
    def neighbor(self) -> NDArray[np.uint16]: ...
    @property
    def source_faces(self) -> NDArray[np.int32] | None: ...
    @property
    def voxels(self) -> int: ...
    @property
    def volume(self) -> float: ...
    @property
    def area(self) -> float: ...
    @property
    def fracture_area(self) -> float: ...
    @property
    def centroid(self) -> NDArray[np.float64]: ...
    @property
    def inertia(self) -> NDArray[np.float64]: ...
    def to_trimesh(self) -> Any: ...

class Fracture(Sequence[Fragment]):
    def __init__(self, core: Any, solid: "Solid | None" = None, options: Options | None = None) -> None: ...
    def __len__(self) -> int: ...
    @overload
    def __getitem__(self, index: int) -> Fragment: ...
    @overload
    def __getitem__(self, index: slice) -> list[Fragment]: ...
    def __iter__(self) -> Iterator[Fragment]: ...
    @property
    def solid(self) -> "Solid | None": ...
    @property
    def options(self) -> Options: ...
    @property
    def seed(self) -> int: ...
    @property
    def voxel_size(self) -> float: ...
    @property
    def origin(self) -> NDArray[np.float64]: ...
    @property
    def offset(self) -> NDArray[np.float64]: ...
    @property
    def unit(self) -> float: ...
    @property
    def up(self) -> str: ...
    @property
    def labels(self) -> NDArray[np.uint16]: ...
    @property
    def sparse_labels(self) -> SparseLabels: ...
    @property
    def contacts(self) -> Contacts: ...
    def points(
        self,
        n: int,
        *,
        progress: _Progress | None = None,
        share_points: bool | None = False,
        point_sampler: Literal["uniform", "halton", "poisson"] | None = "uniform",
        point_rule: Literal["area", "per-triangle"] | None = "area",
    ) -> Points: ...
    def save(
        self,
        folder: _Path,
        *,
        progress: _Progress | None = None,
        points: int | None = 0,
        share_points: bool | None = False,
        point_sampler: Literal["uniform", "halton", "poisson"] | None = "uniform",
        point_rule: Literal["area", "per-triangle"] | None = "area",
        point_format: str | Sequence[Literal["ply", "xyz", "npz", "binp"]] | None = ("ply",),
        sdf_samples: int | None = 0,
        sdf_type: Literal["float32", "float16"] | None = "float32",
        correspondences: int | None = 0,
        density: float | None = 1000,
        proxy_gap: float | None = 0,
        usd_format: str | Sequence[Literal["usda", "usdz"]] | None = ("usda",),
        usd_volumes: bool | None = False,
        joint_strength: float | None = 100000.0,
        vdb: Literal["files", "single", "both"] | None = "files",
        half: bool | None = False,
        vdb_compress: Literal["blosc", "zip", "none"] | None = "blosc",
        write: str | Sequence[Literal["labels", "vdb", "mesh", "preview", "seeds", "boundaries", "cost", "fog", "solid", "scene", "usd", "graph", "houdini", "viewer", "proxy", "points"]] | None = ("labels", "vdb", "mesh", "preview"),
        voxel_format: str | Sequence[Literal["rle", "npy", "npz", "vox", "qstack", "bing"]] | None = ("rle",),
        mesh_format: str | Sequence[Literal["ply", "obj", "glb", "stl", "stl-ascii", "binm"]] | None = ("ply",),
        plain_meshes: bool | None = False,
        precision: Literal["auto", "single", "double"] | None = "auto",
        source_faces: bool | None = False,
        up: Literal["auto", "x", "y", "z"] | None = "auto",
        unit: float | Literal["auto", "mm", "cm", "m", "km", "in", "ft"] | None = "auto",
    ) -> None: ...
    def to_trimesh(self) -> list[Any]: ...
    def render(
        self,
        file: _Path | None = None,
        *,
        explode: float = 0.25,
        azimuth: float = 35.0,
        elevation: float = 20.0,
        up: str = "auto",
        size: tuple[int, int] = (1280, 720),
        progress: _Progress | None = None,
    ) -> NDArray[np.uint8]: ...

class Solid:
    def __init__(self, core: Any) -> None: ...
    @property
    def name(self) -> str: ...
    @property
    def shape(self) -> tuple[int, int, int]: ...
    @property
    def voxel_size(self) -> float: ...
    @property
    def voxels(self) -> int: ...
    @property
    def components(self) -> int: ...
    @property
    def origin(self) -> NDArray[np.float64]: ...
    @property
    def offset(self) -> NDArray[np.float64]: ...
    @property
    def unit(self) -> float: ...
    @property
    def up(self) -> str: ...
    @property
    def options(self) -> Options: ...
    def fractures(
        self,
        pieces: int | Iterable[int] = 8,
        seeds: int | Iterable[int] = (0,),
        *,
        device: str = "builtin",
        progress: _Progress | None = None,
        **options: Any,
    ) -> Iterator[Fracture]: ...

def voxelize(
    mesh: Any,
    *,
    device: str = "builtin",
    progress: _Progress | None = None,
    preset: Literal["paper", "training"] | None = None,
    resolution: int | Literal["auto"] | None = "auto",
    voxel_size: float | None = None,
    fill: Literal["auto", "winding", "parity", "flood", "shell"] | None = "auto",
    shell_thickness: float | None = None,
    bodies: Literal["unite", "keep"] | None = "unite",
    recenter: bool | None = False,
    grid: float | str | os.PathLike[str] | Sequence[Any] | None = None,
    isovalue: float | None = 0.5,
    up: Literal["auto", "x", "y", "z"] | None = "auto",
    unit: float | Literal["auto", "mm", "cm", "m", "km", "in", "ft"] | None = "auto",
    surface: Literal["smooth", "labels", "exact", "auto"] | None = "auto",
) -> Solid: ...
def fracture(
    mesh: Any,
    *,
    device: str = "builtin",
    progress: _Progress | None = None,
    preset: Literal["paper", "training"] | None = None,
    material: Literal["none", "ceramic", "stone", "glass", "tempered", "plaster", "wood", "concrete", "ice"] | None = "none",
    pieces: int | None = 8,
    seed: int | None = 0,
    resolution: int | Literal["auto"] | None = "auto",
    voxel_size: float | None = None,
    fill: Literal["auto", "winding", "parity", "flood", "shell"] | None = "auto",
    shell_thickness: float | None = None,
    bodies: Literal["unite", "keep"] | None = "unite",
    recenter: bool | None = False,
    grid: float | str | os.PathLike[str] | Sequence[Any] | None = None,
    isovalue: float | None = 0.5,
    seeds: float | str | os.PathLike[str] | Sequence[Any] | None = None,
    sampler: Literal["uniform", "halton", "gaussian", "poisson"] | None = "uniform",
    seeds_on: Literal["auto", "volume", "surface", "wall"] | None = "auto",
    extra_seeds: float | str | os.PathLike[str] | Sequence[Any] | None = 0,
    merge_metric: Literal["euclidean", "chebyshev", "manhattan"] | None = "chebyshev",
    size_spread: float | None = 0,
    density_attribute: float | str | os.PathLike[str] | Sequence[Any] | None = None,
    impacts: int | None = 0,
    impact: float | str | os.PathLike[str] | Sequence[Any] | None = None,
    growth: Literal["flood", "nearest", "chain", "euclid", "sequential"] | None = "euclid",
    neighborhood: int | None = 6,
    metric: Literal["euclidean", "chebyshev", "manhattan"] | None = "euclidean",
    split_power: float | None = 1,
    split_offset: float | None = 0.1,
    split_tilt: float | None = 10,
    grain: float | str | os.PathLike[str] | Sequence[Any] | None = None,
    roughness: float | str | os.PathLike[str] | Sequence[Any] | None = 0,
    guide: float | str | os.PathLike[str] | Sequence[Any] | None = None,
    propagation: float | str | os.PathLike[str] | Sequence[Any] | None = None,
    isolated: Literal["keep", "regrow"] | None = "regrow",
    sizes: float | str | os.PathLike[str] | Sequence[Any] | None = "grown",
    min_share: float | Literal["auto"] | None = "auto",
    balance: int | None = 0,
    erode_iterations: float | str | None = 0,
    erode_shape: Literal["cross", "square", "ellipse"] | None = "ellipse",
    erode_size: float | str | None = 3,
    erode_planes: bool | None = False,
    erode_threshold: float | None = 1,
    erode_probability: float | None = 1,
    erode_on: Literal["fracture", "all", "rims"] | None = "fracture",
    erode_islands: Literal["erode", "keep"] | None = "erode",
    drop_share: float | None = 0,
    missing: float | None = 0,
    missing_rule: Literal["neighbors", "any"] | None = "neighbors",
    points: int | None = 0,
    share_points: bool | None = False,
    point_sampler: Literal["uniform", "halton", "poisson"] | None = "uniform",
    point_rule: Literal["area", "per-triangle"] | None = "area",
    point_format: str | Sequence[Literal["ply", "xyz", "npz", "binp"]] | None = ("ply",),
    sdf_samples: int | None = 0,
    sdf_type: Literal["float32", "float16"] | None = "float32",
    correspondences: int | None = 0,
    density: float | None = 1000,
    proxy_gap: float | None = 0,
    usd_format: str | Sequence[Literal["usda", "usdz"]] | None = ("usda",),
    usd_volumes: bool | None = False,
    joint_strength: float | None = 100000.0,
    vdb: Literal["files", "single", "both"] | None = "files",
    half: bool | None = False,
    vdb_compress: Literal["blosc", "zip", "none"] | None = "blosc",
    write: str | Sequence[Literal["labels", "vdb", "mesh", "preview", "seeds", "boundaries", "cost", "fog", "solid", "scene", "usd", "graph", "houdini", "viewer", "proxy", "points"]] | None = ("labels", "vdb", "mesh", "preview"),
    voxel_format: str | Sequence[Literal["rle", "npy", "npz", "vox", "qstack", "bing"]] | None = ("rle",),
    mesh_format: str | Sequence[Literal["ply", "obj", "glb", "stl", "stl-ascii", "binm"]] | None = ("ply",),
    plain_meshes: bool | None = False,
    precision: Literal["auto", "single", "double"] | None = "auto",
    source_faces: bool | None = False,
    up: Literal["auto", "x", "y", "z"] | None = "auto",
    unit: float | Literal["auto", "mm", "cm", "m", "km", "in", "ft"] | None = "auto",
    surface: Literal["smooth", "labels", "exact", "auto"] | None = "auto",
    interface: Literal["shared", "independent"] | None = "shared",
    adaptivity: float | Literal["auto"] | None = "auto",
    smoothing: Literal["taubin", "laplacian"] | None = "taubin",
    smooth_iterations: float | str | os.PathLike[str] | Sequence[Any] | None = 0,
    smooth_weight: float | None = 0.5,
    smooth_boundary_iterations: float | str | os.PathLike[str] | Sequence[Any] | None = 0,
    smooth_boundary_weight: float | None = 0.5,
    mismatch: float | str | os.PathLike[str] | Sequence[Any] | None = "0%",
    mismatch_common: float | None = 0,
    scan_noise: float | str | os.PathLike[str] | Sequence[Any] | None = "0%",
    triangles: int | str | Sequence[int] | None = None,
) -> Fracture: ...
def load(folder: _Path) -> Fracture: ...
def limit_threads(most: int) -> None: ...
