"""Fragments, and the tables of arrays that a fracture gives."""

from __future__ import annotations

from typing import Any, NamedTuple

from ._made import Array, MadeFracture


class Points(NamedTuple):
    """Points on the surfaces of all fragments, one fragment after another."""

    positions: Array
    """(n, 3) float64, world units"""
    normals: Array
    """(n, 3) float64, unit, outwards"""
    neighbor: Array
    """(n,) uint16, id of the fragment on the other side, 0 on the original surface"""
    fragment: Array
    """(n,) uint16, id of the point's fragment"""


class Contacts(NamedTuple):
    """Where fragments touch, each pair once."""

    fragments: Array
    """(n, 2) int32, ids, the lower first"""
    area: Array
    """(n,) float64, world units squared"""
    normal: Array
    """(n, 3) float64, mean direction from the lower id to the higher, unit"""
    centroid: Array
    """(n, 3) float64, world units"""


class SparseLabels(NamedTuple):
    """The voxels of the solid with their fragments."""

    voxels: Array
    """(n, 3) int32, positions in `Fracture.labels`"""
    labels: Array
    """(n,) uint16, as in `Fracture.labels`"""


class Fragment:
    """One fragment of a fracture.

    It belongs to its fracture: each array is made when it is first read, and is then the same at each reading.  Arrays stay when
    fracture and fragment are gone.  What is written into them changes nothing else.

    Attributes
    ----------
    id : int
        1 to the number of fragments.
    """

    def __init__(self, fracture: MadeFracture, index: int) -> None:
        self._fracture = fracture
        self._index = index
        self.id: int = index + 1

    @property
    def vertices(self) -> Array:
        """(n, 3) float64, world units."""
        return self._fracture._arrays(self._index)[0]

    @property
    def faces(self) -> Array:
        """(m, 3) uint32, rows of `vertices`, counter-clockwise seen from outside; a closed mesh."""
        return self._fracture._arrays(self._index)[1]

    @property
    def neighbor(self) -> Array:
        """(m,) uint16, per face the id of the fragment on the other side, 0 on the original surface."""
        return self._fracture._arrays(self._index)[2]

    @property
    def coarse(self) -> list[tuple[Array, Array, Array]]:
        """Vertices, faces and neighbors of the mesh with at most so many faces, for each number of `triangles` that `fracture` was
        given.  Cracks of neighbors are the same at each number."""
        return self._fracture._meshed.coarse(self._index)

    @property
    def source_faces(self) -> Array | None:
        """(m,) int32, per face the index of the input's face on which it lies, -1 on cracks and where a hole was closed.

        None where `fracture` was not given ``source_faces=True``, and of volumes.  A face of a file counts once, with any number of
        corners.
        """
        return self._fracture._source_faces(self._index)

    @property
    def voxels(self) -> int:
        """Number of voxels."""
        return self._fracture._measured.voxels(self._index)

    @property
    def volume(self) -> float:
        """Volume of the mesh, world units cubed."""
        return self._fracture._measured.volume(self._index)

    @property
    def area(self) -> float:
        """Area of the mesh, world units squared."""
        return self._fracture._measured.area(self._index)

    @property
    def fracture_area(self) -> float:
        """Area of the faces that have a neighbor."""
        return self._fracture._measured.fracture_area(self._index)

    @property
    def centroid(self) -> Array:
        """(3,) float64, center of mass, world units."""
        return self._fracture._measured.centroid(self._index)

    @property
    def inertia(self) -> Array:
        """(3, 3) float64, about the centroid at unit density."""
        return self._fracture._measured.inertia(self._index)

    def to_trimesh(self) -> Any:
        """Returns a ``trimesh.Trimesh`` with the face attribute ``neighbor``.

        Raises
        ------
        ImportError
            trimesh is not installed.
        """
        import trimesh

        return trimesh.Trimesh(self.vertices, self.faces, face_attributes={"neighbor": self.neighbor}, process=False)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Fragment) and self._fracture is other._fracture and self._index == other._index

    def __hash__(self) -> int:
        return hash((id(self._fracture), self._index))

    def __repr__(self) -> str:
        return f"<pysherd.Fragment {self.id}>"
