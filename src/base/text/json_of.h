// Conversion of numbers and vectors to JSON.
#pragma once

#include <openvdb/math/Coord.h>

#include <glm/vec3.hpp>
#include <nlohmann/json.hpp>

namespace sherd {

/// Replaces -0 by 0.
[[nodiscard]] inline double plain(double value) { return value + 0.0; }

[[nodiscard]] inline nlohmann::ordered_json jsonOf(const glm::dvec3& v) {
  return {plain(v.x), plain(v.y), plain(v.z)};
}

[[nodiscard]] inline nlohmann::ordered_json jsonOf(const openvdb::Coord& c) {
  return {c.x(), c.y(), c.z()};
}

}  // namespace sherd
