// The ground behind the fragments.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

#include "render/camera.h"
#include "render/light.h"

namespace sherd {

/// Bright paper, darker towards the corners, with the fragments' shadow.
class Backdrop {
 public:
  Backdrop(const Camera& camera, const GroundLight& ground, float groundY);

  /// Returns the light at an image position, pixels.
  [[nodiscard]] glm::vec3 at(float x, float y) const;

  static constexpr int kRows = 16;  ///< that fill() sets

  /// Sets kRows rows of sRGB bytes, or fewer at the image's end.
  ///   firstRow  a multiple of kRows
  ///   rgb       [height * width * 3]
  void fill(int firstRow, std::span<std::uint8_t> rgb) const;

 private:
  const Camera& camera_;
  const GroundLight& ground_;
  float drop_;  // of the ground below the camera
};

}  // namespace sherd
