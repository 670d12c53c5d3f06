// Arrays of NumPy, read.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/memory_budget.h"
#include "formats/arrays/zip_reader.h"

namespace sherd {

/// What the header of an `.npy` file tells.
struct NpyHeader {
  char kind = 'u';  ///< as NumPy has it: u, i, f, b (bool)
  std::size_t itemBytes = 1;
  bool bigEndian = false;
  bool fortranOrder = false;
  std::vector<std::uint64_t> shape;
  std::size_t bodyAt = 0;  ///< first byte behind the header

  /// Numbers in the array.
  [[nodiscard]] std::uint64_t count() const;
  /// As the file has it: "<u2 [3, 4]".
  [[nodiscard]] std::string text() const;
};

/// The header at the beginning of an `.npy` file, format 1, 2 or 3, or nothing: it goes on beyond
/// `bytes`.
///   size    of the whole file
///   throws  Error(input) no `.npy`, no plain numbers, not as many of them as the file holds
[[nodiscard]] std::optional<NpyHeader> npyHeaderOf(std::string_view bytes, std::uint64_t size,
                                                   const std::string& name);

/// Numbers of any type, in C order.
struct NpyNumbers {
  std::vector<std::uint64_t> shape;
  std::vector<double> values;
};

/// The array of that name in an `.npz` file, or nothing.
///   memory  charged with them
///   throws  Error(input) damaged, of more than `most` numbers, or than `memory` holds
[[nodiscard]] std::optional<NpyNumbers> numbersOf(const std::vector<ZipEntry>& entries,
                                                  const std::string& array, std::uint64_t most,
                                                  const std::string& name, MemoryBudget& memory);

/// The entry of an array, or nothing.
[[nodiscard]] const ZipEntry* entryOf(const std::vector<ZipEntry>& entries,
                                      const std::string& array);

}  // namespace sherd
