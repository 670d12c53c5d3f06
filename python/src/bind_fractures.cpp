// Fractures, for Python.
#include "bind_fractures.h"

#include <nanobind/nanobind.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/vector.h>
#include <sherd/error.h>
#include <sherd/render.h>

#include <filesystem>

#include "arrays.h"
#include "fracture.h"
#include "text.h"

namespace pysherd {
namespace {

using FracturePtr = std::shared_ptr<Fracture>;
using sherd::Fragment;
using sherd::Progress;

/// Fragments whose meshes or measures are made, kept alive by their fracture.
struct Fragments {
  FracturePtr of;
  const std::vector<Fragment>* all;

  const Fragment& at(std::size_t i) const { return all->at(i); }
};

template <class Run>
Job* jobOf(FracturePtr fracture, Run run) {
  return new Job([fracture = std::move(fracture),
                  run = std::move(run)](const Progress& progress) mutable -> Made {
    return run(std::move(fracture), progress);
  });
}

Job* fractureJob(SolidPtr solid, GivenOptions given,
                 std::vector<std::pair<int, std::uint64_t>> piecesAndSeeds, std::string device) {
  return new Job([=](const Progress& progress) -> Made {
    auto all = broken(solid, given, piecesAndSeeds, device, progress);
    return [all = std::move(all)] {
      nb::list fractures;
      for (const auto& one : all) fractures.append(nb::cast(one));
      return nb::object(fractures);
    };
  });
}

Job* loadJob(std::string folder) {
  return new Job([=](const Progress&) -> Made {
    auto loaded = freedElsewhere(std::make_unique<LoadedPieces>(folder));
    return [loaded] { return nb::cast(loaded); };
  });
}

Job* againJob(FracturePtr fracture, const std::vector<int>& ids, const GivenOptions& given,
              const std::string& device) {
  return jobOf(std::move(fracture), [=](FracturePtr of, const Progress& progress) -> Made {
    auto one = brokenAgain(*of, ids, given, device, progress);
    return [one] { return nb::cast(one); };
  });
}

Job* labelsJob(FracturePtr fracture) {
  return jobOf(std::move(fracture), [](FracturePtr of, const Progress& progress) -> Made {
    auto voxels = std::make_shared<VoxelIds>(of->labels(progress));
    return [voxels] {
      const auto side = [&](int axis) { return static_cast<std::size_t>(voxels->dims[axis]); };
      return arrayOf<std::uint16_t>(std::move(voxels->ids), {side(0), side(1), side(2)});
    };
  });
}

Job* fragmentsJob(FracturePtr fracture, bool meshes) {
  return jobOf(std::move(fracture), [meshes](FracturePtr of, const Progress& progress) -> Made {
    const auto& all = meshes ? of->meshed(progress) : of->measured(progress);
    return [made = Fragments{std::move(of), &all}] { return nb::cast(made); };
  });
}

// The fragments with the areas and contacts of the surfaces that points lie on.
Job* sampledJob(FracturePtr fracture) {
  return jobOf(std::move(fracture), [](FracturePtr of, const Progress& progress) -> Made {
    const auto& all = of->sampled(progress);
    return [made = Fragments{std::move(of), &all}] { return nb::cast(made); };
  });
}

// Points of all fragments, one after another.
struct AllPoints {
  std::vector<glm::dvec3> positions, normals;
  std::vector<std::uint16_t> neighbor, fragment;
};

AllPoints joined(std::vector<sherd::SurfacePoints> each) {
  AllPoints all;
  std::size_t count = 0;
  for (const sherd::SurfacePoints& own : each) count += own.positions.size();
  all.fragment.reserve(count);
  all.positions.reserve(count);
  all.normals.reserve(count);
  all.neighbor.reserve(count);
  for (std::size_t i = 0; i < each.size(); ++i) {
    sherd::SurfacePoints& own = each[i];
    all.fragment.insert(all.fragment.end(), own.positions.size(),
                        static_cast<std::uint16_t>(i + 1));
    all.positions.insert(all.positions.end(), own.positions.begin(), own.positions.end());
    all.normals.insert(all.normals.end(), own.normals.begin(), own.normals.end());
    all.neighbor.insert(all.neighbor.end(), own.neighbor.begin(), own.neighbor.end());
    own = {};
  }
  all.neighbor.resize(all.fragment.size(), 0);  // meshes of plain files have no neighbors
  return all;
}

// counts  of each fragment, instead of the number that is given; or empty
Job* pointsJob(FracturePtr fracture, const GivenOptions& given, std::vector<std::size_t> counts) {
  const sherd::WriteOptions write = optionsFrom(given).write;
  const PointChoice choice{write.points, write.sharePoints, std::move(counts)};
  return jobOf(std::move(fracture), [choice](FracturePtr of, const Progress& progress) -> Made {
    auto all = std::make_shared<AllPoints>(joined(of->points(choice, progress)));
    return [all]() -> nb::object {
      return nb::make_tuple(arrayOf(std::move(all->positions)), arrayOf(std::move(all->normals)),
                            arrayOf(std::move(all->neighbor)), arrayOf(std::move(all->fragment)));
    };
  });
}

Job* saveJob(std::shared_ptr<GrownPieces> fracture, std::string folder, const GivenOptions& given) {
  const sherd::WriteOptions write = optionsFrom(given).write;
  return new Job([=](const Progress& progress) -> Made {
    const std::vector<std::string> warnings = fracture->save(folder, write, progress);
    return [warnings] { return nb::cast(warnings); };
  });
}

// Returns the image; writes it where `file` is not empty.
Job* renderJob(FracturePtr fracture, std::string file, double explode, double azimuth,
               double elevation, char up, int width, int height) {
  const sherd::RenderOptions options{.width = width,
                                     .height = height,
                                     .explode = explode,
                                     .azimuth = azimuth,
                                     .elevation = elevation,
                                     .up = up};
  return jobOf(std::move(fracture), [=](FracturePtr of, const Progress& progress) -> Made {
    auto image = std::make_shared<sherd::Image>();
    of->withMeshes(progress, [&](const std::vector<Fragment>& fragments) {
      const std::span<const Fragment> all(fragments.data(), of->count());
      if (file.ends_with(".exr")) sherd::writeExr(file, renderAovs(all, options, &progress));
      *image = renderFragments(all, options, &progress);
    });
    if (file.ends_with(".png")) sherd::writePng(file, *image);
    return [image] {
      return arrayOf<std::uint8_t>(std::move(image->rgb),
                                   {static_cast<std::size_t>(image->height),
                                    static_cast<std::size_t>(image->width), std::size_t{3}});
    };
  });
}

// The contacts between fragments, each once.
nb::object contactsOf(const Fragments& fragments) {
  const auto count = static_cast<int>(fragments.of->count());
  std::vector<int> ids;
  std::vector<double> areas;
  std::vector<glm::dvec3> normals, centroids;
  for (int id = 1; id <= count; ++id) {
    for (const sherd::Contact& contact : fragments.at(static_cast<std::size_t>(id - 1)).contacts) {
      if (contact.fragment <= id || contact.fragment > count) continue;
      ids.insert(ids.end(), {id, contact.fragment});
      areas.push_back(contact.area);
      normals.push_back(contact.normal);
      centroids.push_back(contact.centroid);
    }
  }
  const std::size_t contacts = areas.size();
  return nb::make_tuple(arrayOf<int>(std::move(ids), {contacts, std::size_t{2}}),
                        arrayOf(std::move(areas)), arrayOf(std::move(normals)),
                        arrayOf(std::move(centroids)));
}

nb::object inertiaOf(const Fragment& fragment) {
  std::vector<double> numbers;
  for (int column = 0; column < 3; ++column) {
    for (int row = 0; row < 3; ++row) numbers.push_back(fragment.mass.inertia[column][row]);
  }
  return arrayOf<double>(std::move(numbers), {std::size_t{3}, std::size_t{3}});
}

nb::object centroidOf(const Fragment& fragment) {
  const glm::dvec3& at = fragment.mass.centroid;
  return arrayOf(std::vector<double>{at.x, at.y, at.z});
}

nb::tuple arraysOf(const Fragments& fragments, std::size_t i) {
  const HandedArrays& arrays = fragments.of->arrays(i);
  return nb::make_tuple(arrayOf(arrays.vertices), arrayOf(arrays.triangles),
                        arrayOf<std::uint16_t>(arrays.neighbor, {arrays.neighbor->size()}));
}

// Copies, since the same meshes may be read by other threads.
nb::list coarseOf(const Fragments& fragments, std::size_t i) {
  nb::list levels;
  for (const sherd::TriangleMesh& mesh : fragments.at(i).coarse) {
    std::vector<std::uint16_t> neighbor = mesh.neighbor;
    neighbor.resize(mesh.triangles.size(), 0);
    const std::size_t triangles = neighbor.size();
    levels.append(nb::make_tuple(arrayOf(std::vector<glm::dvec3>(mesh.vertices)),
                                 arrayOf(std::vector<glm::uvec3>(mesh.triangles)),
                                 arrayOf<std::uint16_t>(std::move(neighbor), {triangles})));
  }
  return levels;
}

nb::object sourceFacesOf(const Fragments& fragments, std::size_t i) {
  const auto faces = fragments.of->sourceFaces(i);
  return faces ? arrayOf<std::int32_t>(faces, {faces->size()}) : nb::none();
}

void bindFragments(nb::module_& module) {
  using I = std::size_t;
  nb::class_<Fragments>(module, "Fragments")
      .def("arrays", arraysOf)
      .def("coarse", coarseOf)
      .def("source_faces", sourceFacesOf)
      .def("voxels", [](const Fragments& f, I i) { return f.at(i).voxels; })
      .def("volume", [](const Fragments& f, I i) { return f.at(i).mass.volume; })
      .def("area", [](const Fragments& f, I i) { return f.at(i).area; })
      .def("fracture_area", [](const Fragments& f, I i) { return f.at(i).fractureArea; })
      .def("centroid", [](const Fragments& f, I i) { return centroidOf(f.at(i)); })
      .def("inertia", [](const Fragments& f, I i) { return inertiaOf(f.at(i)); })
      .def("contacts", contactsOf);
}

}  // namespace

void bindFractures(nb::module_& module) {
  bindFragments(module);
  nb::class_<Fracture>(module, "Fracture")
      .def_prop_ro("count", &Fracture::count)
      .def_prop_ro("seed", &Fracture::seed)
      .def_prop_ro("smooth_text", &Fracture::smoothText)
      .def_prop_ro("united_text", &Fracture::unitedText)
      .def_prop_ro("parents", &Fracture::parents)
      .def_prop_ro("guide_warnings", &Fracture::guideWarnings)
      .def_prop_ro("voxel_size", [](const Fracture& f) { return f.frame().voxelSize; })
      .def_prop_ro("offset",
                   [](const Fracture& f) {
                     const glm::dvec3 by = f.offset();
                     return nb::make_tuple(by.x, by.y, by.z);
                   })
      .def_prop_ro("unit", [](const Fracture& f) { return f.coordinates().metersPerUnit; })
      .def_prop_ro("up", [](const Fracture& f) { return std::string(1, f.coordinates().up); })
      .def_prop_ro("origin", [](const Fracture& f) {
        const glm::dvec3 at = f.frame().origin;
        return nb::make_tuple(at.x, at.y, at.z);
      });
  nb::class_<GrownPieces, Fracture>(module, "GrownPieces")
      .def_prop_ro("given", &GrownPieces::given);
  nb::class_<LoadedPieces, Fracture>(module, "LoadedPieces")
      .def_prop_ro("file", &LoadedPieces::file);
  module.def("fracture", fractureJob, nb::rv_policy::take_ownership);
  module.def("load", loadJob, nb::rv_policy::take_ownership);
  module.def("options_again", optionsAgain);
  module.def("broken_again", againJob, nb::rv_policy::take_ownership);
  module.def("options_of_whole", [] {
    return std::vector<std::string>(std::begin(sherd::kOptionsOfWhole),
                                    std::end(sherd::kOptionsOfWhole));
  });
  module.def("labels", labelsJob, nb::rv_policy::take_ownership);
  module.def("fragments", fragmentsJob, nb::rv_policy::take_ownership);
  module.def("sampled_fragments", sampledJob, nb::rv_policy::take_ownership);
  module.def("points", pointsJob, nb::arg("fracture"), nb::arg("given"),
             nb::arg("counts") = std::vector<std::size_t>{}, nb::rv_policy::take_ownership);
  module.def("save", saveJob, nb::rv_policy::take_ownership);
  module.def("render", renderJob, nb::rv_policy::take_ownership);
}

}  // namespace pysherd
