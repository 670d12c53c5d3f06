// Reads ZIP files.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "base/memory_budget.h"

namespace sherd {

/// One file of a ZIP file.
struct ZipEntry {
  std::string name;
  int method = 0;           ///< 0 stored, 8 deflated
  std::string_view packed;  ///< as stored in the file
  std::uint64_t size = 0;   ///< unpacked bytes; plausible for the size of `packed`
  std::uint32_t sum = 0;    ///< CRC-32 of the unpacked bytes
};

/// Returns the files in a ZIP file's central directory; supports ZIP64.
///   name    for messages
///   memory  charged with the entries; null: no limit
///   throws  Error(input) no ZIP file, cut, inconsistent; more than `memory` allows
[[nodiscard]] std::vector<ZipEntry> zipEntries(std::string_view bytes, const std::string& name,
                                               MemoryBudget* memory = nullptr);

/// Unpacks an entry block by block into `take`.
///   throws  Error(input) another compression method; a length or CRC-32 that does not match
void unpack(const ZipEntry& entry, const std::string& name,
            const std::function<void(std::string_view)>& take);

}  // namespace sherd
