// The ground behind the fragments.
#include "render/backdrop.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <vector>

#include "render/palette.h"

namespace sherd {
namespace {

// Light varies slowly: it is found at every fourth pixel of every fourth row, and its sRGB values
// are interpolated.
constexpr int kStep = 4;
static_assert(Backdrop::kRows % kStep == 0);

using Node = std::array<float, 3>;  // bytes

}  // namespace

Backdrop::Backdrop(const Camera& camera, const GroundLight& ground, float groundY)
    : camera_(camera), ground_(ground), drop_(camera.eye.y - groundY) {}

glm::vec3 Backdrop::at(float x, float y) const {
  const float u = 0.5f * x / camera_.halfWidth - 0.5f, v = 0.5f * y / camera_.halfHeight - 0.44f;
  const glm::vec3 middle(0.890f, 0.878f, 0.855f), corner(0.700f, 0.690f, 0.675f);
  const glm::vec3 paper =
      glm::mix(middle, corner, glm::smoothstep(0.1f, 0.85f, std::sqrt(u * u + v * v)));
  const glm::vec3 d = camera_.direction(x, y);
  if (d.y >= 0.0f || drop_ <= 0.0f) return paper;
  const float t = drop_ / -d.y;
  return paper * ground_.at(camera_.eye.x + t * d.x, camera_.eye.z + t * d.z);
}

void Backdrop::fill(int firstRow, std::span<std::uint8_t> rgb) const {
  const int width = static_cast<int>(2.0f * camera_.halfWidth);
  const int height = static_cast<int>(2.0f * camera_.halfHeight);
  const int nodes = (width + kStep - 1) / kStep + 1;
  const auto nodesOf = [&](int row) {
    std::vector<Node> line(static_cast<std::size_t>(nodes));
    for (int i = 0; i < nodes; ++i) {
      const glm::vec3 light =
          at(static_cast<float>(kStep * i) + 0.5f, static_cast<float>(row) + 0.5f);
      for (int k = 0; k < 3; ++k)
        line[static_cast<std::size_t>(i)][static_cast<std::size_t>(k)] =
            255.0f * srgbFromLinear(light[k]);
    }
    return line;
  };
  std::vector<Node> above = nodesOf(firstRow), below, between(above.size());
  for (int y = firstRow; y < std::min(height, firstRow + kRows); ++y) {
    const int inStep = y % kStep;
    if (inStep == 0) {
      if (y > firstRow) above = below;
      below = nodesOf(y + kStep);
    }
    const float t = static_cast<float>(inStep) / kStep;
    for (std::size_t i = 0; i < above.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k)
        between[i][k] = above[i][k] + t * (below[i][k] - above[i][k]) + 0.5f;
    std::uint8_t* row = &rgb[3 * static_cast<std::size_t>(y) * static_cast<std::size_t>(width)];
    for (int x = 0; x < width; x += kStep) {
      const Node &left = between[static_cast<std::size_t>(x / kStep)],
                 &right = between[static_cast<std::size_t>(x / kStep + 1)];
      for (int i = 0; i < std::min(kStep, width - x); ++i)
        for (std::size_t k = 0; k < 3; ++k)
          *row++ = static_cast<std::uint8_t>(
              static_cast<int>(left[k] + static_cast<float>(i) / kStep * (right[k] - left[k])));
    }
  }
}

}  // namespace sherd
