// Exceptions of the library as Python's.
#pragma once

#include <nanobind/nanobind.h>

namespace pysherd {

namespace nb = nanobind;

/// Translates sherd::Error; std::bad_alloc becomes MemoryError.
void bindErrors();

}  // namespace pysherd
