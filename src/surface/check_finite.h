// The last check of fragments: that all of their numbers are finite.
#pragma once

#include <sherd/error.h>
#include <sherd/fragments.h>

#include <span>
#include <vector>

namespace sherd {

/// Checks the vertices of a fragment's meshes, and its measures without contacts.
///   throws  Error(internal), which names the fragment and the stage "extract"
void checkFinite(const Fragment& fragment);

/// Checks [fragments] the contacts of each.
///   throws  as above
void checkFinite(std::span<const std::vector<Contact>> contacts);

/// Returns the error of a number that is not finite.
///   what   of the fragment
///   stage  that made it
[[nodiscard]] Error notFinite(int fragment, const char* what, const char* stage);

}  // namespace sherd
