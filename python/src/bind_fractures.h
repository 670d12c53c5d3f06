// Fractures, for Python.
#pragma once

#include <nanobind/nanobind.h>

namespace pysherd {

void bindFractures(nanobind::module_& module);

}  // namespace pysherd
