// Solids as pickle keeps them.
#pragma once

#include <nanobind/nanobind.h>

#include <memory>
#include <utility>

#include "options.h"
#include "solid.h"

namespace pysherd {

/// Returns the state of a solid, see sealed.h: its options, and its mesh with all that was read
/// beside it, or the level set of one that has no mesh.
[[nodiscard]] nanobind::bytes stateOf(const Solid& solid);

/// Returns the object that makes the same solid again, and its options, which are not checked.
///   throws  Error(input) the state is damaged, or what it holds is no mesh
[[nodiscard]] std::pair<std::shared_ptr<Object>, GivenOptions> objectOfState(
    nanobind::handle state);

}  // namespace pysherd
