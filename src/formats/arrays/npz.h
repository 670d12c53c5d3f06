// Arrays for NumPy, written.
#pragma once

#include <sherd/output_file.h>

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "formats/arrays/zip_writer.h"

namespace sherd {

/// An array of numbers, in C order.
struct NpyArray {
  std::string name;                ///< as numpy.load names it: letters
  std::string_view type;           ///< NumPy's word for it: "<f4", "<f2", "<i4"
  std::vector<std::size_t> shape;  ///< empty for a single number
  std::string bytes;               ///< the numbers, little-endian
};

/// The header of a `.npy` file, format 1.0, which the numbers follow.  `bytes` is not looked at.
[[nodiscard]] std::string npyHeader(const NpyArray& array);

/// Write arrays as `.npz`: a ZIP file of stored `.npy` files, format 1.0.  It has no times in it:
/// equal arrays give equal bytes.
///   arrays  under 4 GiB in all
///   throws  Error(output)
void writeNpz(const OutputFile& file, std::span<const NpyArray> arrays);

/// Writes a ZIP file of `.npy` files, one after another.
class NpzWriter {
 public:
  explicit NpzWriter(ByteSink sink) : zip_(std::move(sink)) {}

  void store(const NpyArray& array);

  /// Deflated; what it unpacks to may be larger than memory.
  ///   array    without its bytes
  ///   numbers  hands them to a sink
  ///   throws   Error(output) it is above 4 GiB even when packed
  void deflate(const NpyArray& array, const Content& numbers);

  /// Write the directory, which ends the file.
  void finish() { zip_.finish(); }

 private:
  void add(const PackedFile& file);

  ZipWriter zip_;
};

}  // namespace sherd
