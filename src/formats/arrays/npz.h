// Writes NumPy arrays.
#pragma once

#include <sherd/files.h>

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "formats/arrays/zip_writer.h"

namespace sherd {

/// An array of numbers, in C order.
struct NpyArray {
  std::string name;                ///< its key in numpy.load: letters
  std::string_view type;           ///< NumPy's type string: "<f4", "<f2", "<i4"
  std::vector<std::size_t> shape;  ///< empty for a single number
  std::string bytes;               ///< the numbers, little-endian
};

/// Returns the header of a `.npy` file, format 1.0, without the numbers. `bytes` is not read.
[[nodiscard]] std::string npyHeader(const NpyArray& array);

/// Writes arrays as `.npz`: a ZIP file of stored `.npy` files, format 1.0. Timestamps are constant:
/// equal arrays give equal bytes.
///   arrays  under 4 GiB in all
///   throws  Error(output)
void writeNpz(const OutputFile& file, std::span<const NpyArray> arrays);

/// Returns the file of a stored array, summed up to its numbers; addStored adds those.
[[nodiscard]] PackedFile storedFile(const NpyArray& array);

/// Writes a ZIP file of `.npy` files, one after another.
class NpzWriter {
 public:
  explicit NpzWriter(ByteSink sink) : sink_(sink), zip_(std::move(sink)) {}

  void store(const NpyArray& array);

  /// Adds a stored array whose numbers need not fit in memory.
  ///   array    its `bytes` are ignored
  ///   numbers  writes the numbers to a sink
  ///   summed   storedFile(array), with the numbers added
  void store(const NpyArray& array, const Content& numbers, const PackedFile& summed);

  /// Adds a deflated array; its numbers need not fit in memory.
  ///   array    its `bytes` are ignored
  ///   numbers  writes the numbers to a sink
  ///   throws   Error(output) the file exceeds 4 GiB
  void deflate(const NpyArray& array, const Content& numbers);

  /// Writes the directory, which ends the file.
  void finish() { zip_.finish(); }

 private:
  void add(const PackedFile& file);

  ByteSink sink_;
  ZipWriter zip_;
};

}  // namespace sherd
