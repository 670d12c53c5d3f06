// Objects to break, and solids, for Python.
#include <nanobind/nanobind.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/vector.h>
#include <sherd/error.h>
#include <sherd/folder.h>

#include <cstring>

#include "arrays.h"
#include "base/memory.h"
#include "pickled.h"
#include "solid.h"
#include "text.h"

namespace pysherd {
namespace {

template <class Scalar>
using Rows = nb::ndarray<const Scalar, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;
using MaskArray = nb::ndarray<const std::uint8_t, nb::ndim<3>, nb::c_contig, nb::device::cpu>;

template <class Vector, class Scalar>
std::vector<Vector> vectorsOf(const Rows<Scalar>& rows) {
  static_assert(sizeof(Vector) == 3 * sizeof(Scalar));
  std::vector<Vector> vectors(rows.shape(0));
  if (!vectors.empty()) std::memcpy(vectors.data(), rows.data(), rows.size() * sizeof(Scalar));
  return vectors;
}

// The Python side has checked shapes, numbers and indices.  Arrays are only copied here: an
// interrupt would wait for more.
std::shared_ptr<Object> meshObject(const Rows<double>& vertices, const Rows<std::uint32_t>& faces) {
  auto object = std::make_shared<Object>();
  object->mesh.vertices = vectorsOf<glm::dvec3>(vertices);
  object->mesh.triangles = vectorsOf<glm::uvec3>(faces);
  return object;
}

std::shared_ptr<Object> fileObject(std::string file) {
  auto object = std::make_shared<Object>();
  object->file = std::move(file);
  return object;
}

std::shared_ptr<Object> volumeObject(const MaskArray& mask) {
  auto object = std::make_shared<Object>();
  const auto side = [&](std::size_t axis) { return static_cast<int>(mask.shape(axis)); };
  object->mask = Mask{{side(0), side(1), side(2)}, {mask.data(), mask.data() + mask.size()}};
  object->name = "volume";
  return object;
}

Job* voxelizeJob(const std::shared_ptr<Object>& object, GivenOptions given, std::string device) {
  return new Job([object, given = std::move(given),
                  device = std::move(device)](const sherd::Progress& progress) -> Made {
    const SolidPtr solid = voxelized(std::move(*object), given, device, progress);
    return [solid] { return nb::cast(solid); };
  });
}

// What may be lost of the object, in sentences; what is lost of its volume is known of fragments.
std::vector<std::string> warningsOf(const Solid& solid) {
  sherd::FractureResult result;
  result.solid = solid.solid();
  result.fragments.emplace_back().mass.volume = result.solid.report.meshVolume;
  std::vector<std::string> warnings = solid.idle();
  const std::vector<std::string>& read = solid.source().warnings;
  warnings.insert(warnings.end(), read.begin(), read.end());
  for (std::string& own : meshWarnings(solid.source(), result)) warnings.push_back(std::move(own));
  return warnings;
}

// What distinguishes it from other solids: what it was made of, how, and
// what came out.
nb::tuple identityOf(const Solid& s) {
  return nb::make_tuple(s.source().sha256, s.ownVoxelSize(), s.given(), s.solid().voxels,
                        s.solid().frame.voxelSize);
}

nb::tuple vectorOf(const glm::dvec3& v) { return nb::make_tuple(v.x, v.y, v.z); }

}  // namespace

void bindSolids(nb::module_& module) {
  nb::class_<Object>(module, "Object").def_ro("file", &Object::file);
  module.def("mesh_object", meshObject);
  module.def("file_object", fileObject);
  module.def("volume_object", volumeObject);
  module.def("object_of_state", objectOfState);
  module.def("voxelize", voxelizeJob, nb::rv_policy::take_ownership);
  module.def("free_memory", sherd::freeMemory);
  nb::class_<Solid>(module, "Solid")
      .def_prop_ro("state", stateOf)
      .def_prop_ro("identity", identityOf)
      .def_prop_ro("warnings", warningsOf)
      .def_prop_ro("given", &Solid::given)
      .def_prop_ro("name", [](const Solid& s) { return s.source().name; })
      .def_prop_ro("components", &Solid::components)
      .def_prop_ro("voxels", [](const Solid& s) { return s.solid().voxels; })
      .def_prop_ro("voxel_size", [](const Solid& s) { return s.solid().frame.voxelSize; })
      .def_prop_ro("keeps_mesh", [](const Solid& s) { return s.solid().mesh != nullptr; })
      .def_prop_ro("surface_box",
                   [](const Solid& s) {
                     const sherd::Box box = s.surfaceBox();
                     return nb::make_tuple(vectorOf(box.min), vectorOf(box.max));
                   })
      .def_prop_ro("shape",
                   [](const Solid& s) {
                     const openvdb::Coord dims = s.solid().box.dims();
                     return nb::make_tuple(dims.x(), dims.y(), dims.z());
                   })
      .def_prop_ro("offset",
                   [](const Solid& s) { return vectorOf(s.offset().value_or(glm::dvec3(0.0))); })
      .def_prop_ro("unit", [](const Solid& s) { return s.source().coordinates.metersPerUnit; })
      .def_prop_ro("up", [](const Solid& s) { return std::string(1, s.source().coordinates.up); })
      .def_prop_ro("origin", [](const Solid& s) {
        return vectorOf(s.solid().frame.worldFromIndex(s.solid().box.min));
      });
}

}  // namespace pysherd
