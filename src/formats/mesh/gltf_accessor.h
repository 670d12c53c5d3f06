// The arrays of a glTF file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "formats/mesh/gltf_document.h"

namespace sherd {

/// Elements of some numbers each.
struct GltfArray {
  std::size_t count = 0;
  std::size_t components = 0;  ///< 1 to 16
  std::vector<double> values;  ///< [count * components]

  double at(std::size_t element, std::size_t component) const {
    return values[element * components + component];
  }
};

/// What accessor number `index` holds, sparse or not; whole numbers that are normalised become
/// 0..1 or -1..1.
///   throws  Error(input) no such accessor, sparse parts that contradict themselves, more memory
///           than may be used, which is charged
[[nodiscard]] GltfArray readGltfArray(const GltfDocument& document, std::size_t index);

/// Whole number that is normalised: its share of the most that its type can tell.
///   componentType  5120 to 5125, as glTF has them
[[nodiscard]] double normalised(double value, std::size_t componentType);

}  // namespace sherd
