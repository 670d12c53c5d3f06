// Solids as pickle keeps them.
#pragma once

#include <nanobind/nanobind.h>

#include <memory>

#include "solid.h"

namespace pysherd {

/// Returns the mesh of a solid with all that was read beside it, or the level set of one that has
/// no mesh, and its options: a dictionary of bytes and numbers.
[[nodiscard]] nanobind::dict stateOf(const Solid& solid);

/// Returns the object that makes the same solid again.
///   throws  Error(input) the state is damaged
[[nodiscard]] std::shared_ptr<Object> objectOfState(const nanobind::dict& state);

}  // namespace pysherd
