// Reads NumPy arrays.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/memory_budget.h"
#include "formats/arrays/zip_reader.h"

namespace sherd {

/// The content of an `.npy` file's header.
struct NpyHeader {
  char kind = 'u';  ///< NumPy's kind: u, i, f, b (bool)
  std::size_t itemBytes = 1;
  bool bigEndian = false;
  bool fortranOrder = false;
  std::vector<std::uint64_t> shape;
  std::size_t bodyAt = 0;  ///< offset of the first byte after the header

  /// Numbers in the array.
  [[nodiscard]] std::uint64_t count() const;
  /// Type and shape for messages: "<u2 [3, 4]".
  [[nodiscard]] std::string text() const;
};

/// Returns the header at the beginning of an `.npy` file, format 1, 2 or 3; nothing if it continues
/// beyond `bytes`.
///   size    of the whole file, bytes
///   throws  Error(input) not an `.npy` file, a type that is not a plain number, a shape that
///           contradicts the file's size
[[nodiscard]] std::optional<NpyHeader> npyHeaderOf(std::string_view bytes, std::uint64_t size,
                                                   const std::string& name);

/// Numbers of any type, in C order.
struct NpyNumbers {
  std::vector<std::uint64_t> shape;
  std::vector<double> values;
};

/// Returns the array with that name in an `.npz` file, or nothing.
///   memory  charged with the numbers
///   throws  Error(input) damaged, more than `most` numbers, more than `memory` allows
[[nodiscard]] std::optional<NpyNumbers> numbersOf(const std::vector<ZipEntry>& entries,
                                                  const std::string& array, std::uint64_t most,
                                                  const std::string& name, MemoryBudget& memory);

/// Returns the entry of an array, or null.
[[nodiscard]] const ZipEntry* entryOf(const std::vector<ZipEntry>& entries,
                                      const std::string& array);

}  // namespace sherd
