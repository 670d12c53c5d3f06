// Jacobi's method, and OpenVDB's.
#include "mesh/symmetric_eigen.h"

#include <openvdb/math/Mat3.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <utility>

namespace sherd {

// Jacobi's method, which is accurate also where two eigenvalues are almost equal, as for slivers.
SymmetricEigen eigenOf(glm::dmat3 m) {
  constexpr int kSweeps = 12;
  glm::dmat3 vectors(1.0);
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    if (m[0][1] == 0.0 && m[0][2] == 0.0 && m[1][2] == 0.0) break;
    for (const auto& [p, q] : {std::pair(0, 1), {0, 2}, {1, 2}}) {
      if (std::abs(m[p][q]) <= 1e-18 * (std::abs(m[p][p]) + std::abs(m[q][q]))) {
        m[p][q] = m[q][p] = 0.0;
        continue;
      }
      const double ratio = (m[q][q] - m[p][p]) / (2.0 * m[p][q]);
      const double t = std::copysign(1.0, ratio) / (std::abs(ratio) + std::hypot(ratio, 1.0));
      const double c = 1.0 / std::hypot(t, 1.0), s = t * c;
      glm::dmat3 rotation(1.0);
      rotation[p][p] = rotation[q][q] = c;
      rotation[q][p] = s;
      rotation[p][q] = -s;
      m = glm::transpose(rotation) * m * rotation;
      vectors = vectors * rotation;
      m[p][q] = m[q][p] = 0.0;
    }
  }
  std::array<int, 3> order{0, 1, 2};
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return m[a][a] > m[b][b]; });
  SymmetricEigen result;
  for (int i = 0; i < 3; ++i) {
    const int k = order[static_cast<std::size_t>(i)];
    result.values[i] = m[k][k];
    result.vectors[static_cast<std::size_t>(i)] = glm::normalize(vectors[k]);
  }
  return result;
}

// Once all entries beside the diagonal are below its threshold but their sum is not, OpenVDB
// divides the first entry of the diagonal by itself: the first vector is then too short, or all of
// them are not numbers where that entry is 0.
SymmetricEigen fastEigenOf(const glm::dmat3& symmetric) {
  constexpr double kRounding = 1e-6;
  openvdb::math::Mat3d matrix, vectors;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) matrix(row, column) = symmetric[column][row];
  }
  openvdb::math::Vec3d values;
  bool isUsable = openvdb::math::diagonalizeSymmetricMatrix(matrix, vectors, values);
  SymmetricEigen result;
  for (int k = 0; k < 3; ++k) {
    const glm::dvec3 vector(vectors(0, k), vectors(1, k), vectors(2, k));
    isUsable = isUsable && std::abs(glm::dot(vector, vector) - 1.0) < kRounding;
    result.values[k] = values[k];
    result.vectors[static_cast<std::size_t>(k)] = vector;
  }
  return isUsable ? result : eigenOf(symmetric);
}

}  // namespace sherd
