// Eigenvalues and eigenvectors of symmetric matrices.
#pragma once

#include <array>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

namespace sherd {

/// Eigenvalues of a symmetric matrix, with unit eigenvectors at right angles.
struct SymmetricEigen {
  glm::dvec3 values{0.0};
  std::array<glm::dvec3, 3> vectors{};
};

/// Returns them by descending eigenvalue.
[[nodiscard]] SymmetricEigen eigenOf(glm::dmat3 symmetric);

/// Returns them in no order, in less time.
[[nodiscard]] SymmetricEigen fastEigenOf(const glm::dmat3& symmetric);

}  // namespace sherd
