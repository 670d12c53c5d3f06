// Endless fractures for training: options whose values are drawn, libraries of meshes, and solids
// that are kept between fractures.
#include "stream.h"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/vector.h>
#include <sherd/dataset.h>
#include <sherd/error.h>
#include <sherd/options.h>

#include "options.h"
#include "solid.h"
#include "text.h"

namespace pysherd {
namespace {

using sherd::DrawnOption;
using sherd::Error;
using sherd::ErrorCode;

std::vector<std::string> endsOf(const DrawnOption& drawn) {
  if (!drawn.choices.empty()) return drawn.choices;
  return {drawn.low, drawn.high};
}

// Returns the drawn option for a text, or nullopt if the text is a single value.  `pieces`, of
// which a dataset takes every number, is drawn here.
std::optional<DrawnOption> drawnOf(const std::string& name, const std::string& text) {
  const std::size_t dots = text.find("..");
  if (name != "pieces" || dots == std::string::npos) return sherd::drawnOption(name, text);
  DrawnOption drawn{name, text.substr(0, dots), text.substr(dots + 2), {}};
  const auto numberAt = [&](const std::string& end) {
    return optionsFrom({{name, end}}).fracture.pieces;
  };
  if (numberAt(drawn.low) > numberAt(drawn.high)) {
    throw Error(ErrorCode::usage, "pieces: '" + text + "' is empty; give the lower number first");
  }
  return drawn;
}

// Objects by their paths in the library, with their files, and a sentence for each skipped path.
nb::tuple objectsOf(const std::string& library) {
  std::vector<std::string> skipped;
  std::vector<std::pair<std::string, std::string>> found;
  for (const sherd::LibraryObject& object : sherd::findObjects(library, {}, &skipped)) {
    found.emplace_back(object.key, object.file.string());
  }
  return nb::make_tuple(nb::cast(found), nb::cast(skipped));
}

// Makes the surface of the intact solid, which each fracture of it then uses, and returns the bytes
// that the solid takes.  OpenVDB counts them by TBB.
Job* keepSurfaceJob(const SolidPtr& solid) {
  return new Job([solid](const sherd::Progress&) -> Made {
    solid->keepSurface();
    return [bytes = solid->bytes()] { return nb::cast(bytes); };
  });
}

}  // namespace

void bindStreams(nb::module_& module) {
  nb::class_<DrawnOption>(module, "DrawnOption")
      .def_ro("name", &DrawnOption::name)
      .def_prop_ro("ends", endsOf)
      .def("value", &DrawnOption::valueFor);
  module.def("drawn_option", drawnOf);
  module.def("find_objects", objectsOf);
  module.def("keep_surface", keepSurfaceJob, nb::rv_policy::take_ownership);
}

}  // namespace pysherd
