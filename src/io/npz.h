// Arrays for NumPy.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sherd {

/// An array of numbers, in C order.
struct NpyArray {
  std::string name;                ///< as numpy.load names it: letters
  std::string_view type;           ///< NumPy's word for it: "<f4", "<f2", "<i4"
  std::vector<std::size_t> shape;  ///< at least one
  std::string bytes;               ///< the numbers, little-endian
};

/// The header of a `.npy` file, format 1.0, which the numbers follow.  `bytes` is not looked at.
[[nodiscard]] std::string npyHeader(const NpyArray& array);

/// Write arrays as `.npz`: a ZIP file of stored `.npy` files, format 1.0.  It has no times in it:
/// equal arrays give equal bytes.
///   arrays  under 4 GiB in all
///   throws  Error(output)
void writeNpz(const std::filesystem::path& file, std::span<const NpyArray> arrays);

}  // namespace sherd
