// NumPy's arrays of arrays, which it stores as Python's pickles.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "formats/arrays/npz.h"

namespace sherd {

/// A table of whole numbers.
struct NpyTable {
  std::size_t columns = 1;
  std::vector<std::int64_t> numbers;  ///< [rows * columns]
};

/// Returns an array of dtype object, shape [tables], of int64 arrays [rows, columns], as numpy.save
/// writes it.  The pickle names nothing but NumPy's own array and dtype; reading it needs
/// numpy.load(..., allow_pickle=True).
///   source  Python, pickletools (protocol 3); NumPy, ndarray.__reduce__ and dtype.__reduce__
[[nodiscard]] NpyArray npyObjects(std::string name, std::span<const NpyTable> tables);

}  // namespace sherd
