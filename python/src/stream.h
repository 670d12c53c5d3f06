// Endless fractures for training: options whose values are drawn, libraries of meshes, and solids
// that are kept between fractures.
#pragma once

#include <nanobind/nanobind.h>

namespace pysherd {

void bindStreams(nanobind::module_& module);

}  // namespace pysherd
