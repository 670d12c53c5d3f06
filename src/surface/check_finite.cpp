// The last check of fragments: that all of their numbers are finite.
#include "surface/check_finite.h"

#include <array>
#include <cmath>
#include <string>

#include "base/finite.h"

namespace sherd {
namespace {

constexpr const char* kStage = "extract";

}  // namespace

Error notFinite(int fragment, const char* what, const char* stage) {
  return {ErrorCode::internal, "fragment " + std::to_string(fragment) + ", stage " + stage + ": " +
                                   what +
                                   " is not a finite number; please report it with the "
                                   "input and the options"};
}

void checkFinite(const Fragment& fragment) {
  const auto require = [&](bool isFinite, const char* what) {
    if (!isFinite) throw notFinite(fragment.id, what, kStage);
  };
  const MassProperties& mass = fragment.mass;
  require(areFinite(fragment.mesh.vertices), "a vertex");
  for (const TriangleMesh& coarse : fragment.coarse)
    require(areFinite(coarse.vertices), "a vertex of a decimated mesh");
  require(std::isfinite(mass.volume), "the volume");
  require(areFinite(std::span(&mass.centroid, 1)), "the centroid");
  for (int axis = 0; axis < 3; ++axis)
    require(areFinite(std::span(&mass.inertia[axis], 1)), "the inertia");
  require(std::isfinite(fragment.area) && std::isfinite(fragment.fractureArea), "the area");
}

void checkFinite(std::span<const std::vector<Contact>> contacts) {
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    for (const Contact& contact : contacts[i]) {
      const std::array<glm::dvec3, 2> vectors{contact.normal, contact.centroid};
      if (std::isfinite(contact.area) && areFinite(vectors)) continue;
      throw notFinite(static_cast<int>(i) + 1, "a contact", kStage);
    }
  }
}

}  // namespace sherd
