"""The unit and the upward axis of solids and fractures."""
import pickle

import numpy as np
import pysherd
import pytest
from conftest import cube


def stl(path, side):
    """A cube in text STL, which has millimeters and z up by its format."""
    vertices, faces = cube(side)
    corners = "".join("facet normal 0 0 0\nouter loop\n" + "".join("vertex %r %r %r\n" % tuple(map(float, vertices[i])) for i in f) + "endloop\nendfacet\n" for f in faces)
    path.write_text("solid cube\n" + corners + "endsolid cube\n")
    return path


def test_a_file_has_those_of_its_format(tmp_path):
    solid = pysherd.voxelize(stl(tmp_path / "a.stl", 100.0), resolution=16)
    assert (solid.unit, solid.up) == (0.001, "z")
    assert (solid.unit, solid.up) == tuple(getattr(pysherd.fracture(solid, pieces=2), name) for name in ("unit", "up"))


def test_arrays_have_meters_and_y_up_unless_it_is_said():
    solid = pysherd.voxelize(cube(), resolution=16)
    assert (solid.unit, solid.up) == (1.0, "y")
    solid = pysherd.voxelize(cube(), resolution=16, unit="in", up="z")
    assert (solid.unit, solid.up) == (0.0254, "z")
    again = pickle.loads(pickle.dumps(solid))
    assert (again.unit, again.up) == (0.0254, "z")
    assert pysherd.voxelize(cube(), resolution=16, unit=0.5).unit == 0.5
    for wrong in ("yard", 0, -1, float("nan")):
        with pytest.raises(pysherd.UsageError, match="unit"):
            pysherd.voxelize(cube(), unit=wrong)


def test_a_saved_fracture_has_them_and_is_rendered_by_them(tmp_path):
    fracture = pysherd.fracture(pysherd.voxelize(stl(tmp_path / "a.stl", 100.0), resolution=16), pieces=3)
    fracture.save(tmp_path / "f", write="mesh", unit="cm")
    loaded = pysherd.load(tmp_path / "f")
    assert (loaded.unit, loaded.up) == (0.01, "z")
    image = loaded.render(size=(64, 48))
    assert np.array_equal(image, loaded.render(size=(64, 48), up="z"))
    assert not np.array_equal(image, loaded.render(size=(64, 48), up="y"))


def test_trimesh_sees_the_object_upright_and_in_its_size(tmp_path):
    trimesh = pytest.importorskip("trimesh")
    vertices, faces = cube()
    solid = pysherd.voxelize((vertices * [100, 200, 400], faces), resolution=16, unit="mm", up="z")
    pysherd.fracture(solid, pieces=1).save(tmp_path / "out", write=["scene", "mesh"], mesh_format="glb")
    for file in (tmp_path / "out" / "scene.glb", next((tmp_path / "out" / "meshes").iterdir())):
        np.testing.assert_allclose(trimesh.load(file).extents, [0.1, 0.4, 0.2], rtol=1e-6)
