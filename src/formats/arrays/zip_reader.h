// What is in a ZIP file.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace sherd {

/// One file of a ZIP file.
struct ZipEntry {
  std::string name;
  int method = 0;           ///< 0 stored, 8 deflated
  std::string_view packed;  ///< as it lies in the file
  std::uint64_t size = 0;   ///< unpacked; no more than deflation can make of `packed`
  std::uint32_t sum = 0;    ///< CRC-32 of what it unpacks to
};

/// The files of a ZIP file, by its central directory; ZIP64 too.
///   name    for messages
///   throws  Error(input) no ZIP file, cut, contradicting itself
[[nodiscard]] std::vector<ZipEntry> zipEntries(std::string_view bytes, const std::string& name);

/// Unpack an entry, piece by piece.
///   throws  Error(input) packed by another method, damaged: told by its length and CRC-32
void unpack(const ZipEntry& entry, const std::string& name,
            const std::function<void(std::string_view)>& take);

}  // namespace sherd
