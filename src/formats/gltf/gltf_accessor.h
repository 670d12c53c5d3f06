// The arrays of a glTF file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "formats/gltf/gltf_document.h"

namespace sherd {

/// An array whose elements have several numbers each.
struct GltfArray {
  std::size_t count = 0;
  std::size_t components = 0;  ///< 1 to 16
  std::vector<double> values;  ///< [count * components]

  double at(std::size_t element, std::size_t component) const {
    return values[element * components + component];
  }
};

/// Returns the content of accessor number `index`, sparse or not; normalized integers become 0..1
/// or -1..1.
///   throws  Error(input) no such accessor, inconsistent sparse parts, more memory than allowed,
///           which is charged
[[nodiscard]] GltfArray readGltfArray(const GltfDocument& document, std::size_t index);

/// Returns a normalized integer as a fraction of its type's largest value.
///   componentType  5120 to 5125, as in glTF
[[nodiscard]] double normalized(double value, std::size_t componentType);

}  // namespace sherd
