// The strength of the joints between fragments in scenes.
#pragma once

#include <sherd/fragments.h>

namespace sherd {

/// Returns the force that breaks the joint of a contact, as files have it.
///   perArea  WriteOptions::jointStrength
[[nodiscard]] inline float jointStrength(const Contact& contact, double perArea) {
  return static_cast<float>(perArea * contact.area);
}

}  // namespace sherd
