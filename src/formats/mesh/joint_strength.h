// The strength of the joints between fragments in scenes.
#pragma once

#include <sherd/fragments.h>

namespace sherd {

/// Returns the force that breaks the joint of a contact.
///   perArea  WriteOptions::jointStrength
[[nodiscard]] inline double jointStrength(const Contact& contact, double perArea) {
  return perArea * contact.area;
}

}  // namespace sherd
