// ZIP files, written.
#pragma once

#include <sherd/output_file.h>

#include <cstdint>
#include <string>

namespace sherd {

/// A file packed for a ZIP file.  It has no time: equal files give equal bytes.
struct PackedFile {
  std::string name;
  bool deflated = false;
  std::uint32_t sum = 0;   ///< CRC-32 of what it unpacks to
  std::uint64_t size = 0;  ///< unpacked
  std::string bytes;       ///< packed
};

[[nodiscard]] PackedFile packed(std::string name, bool deflate, const Content& content);

/// Writes a ZIP file, a packed file after another; ZIP64 where 32 bits do not do.
class ZipWriter {
 public:
  explicit ZipWriter(ByteSink sink) : sink_(std::move(sink)) {}

  void add(const PackedFile& file);

  /// Note a file that lies at the end of what is there already.
  ///   file  without its bytes
  ///   size  of these
  void note(const PackedFile& file, std::uint64_t size);

  /// Write the directory, which ends the ZIP file.
  void finish();

  /// Bytes so far.
  [[nodiscard]] std::uint64_t offset() const { return offset_; }

 private:
  ByteSink sink_;
  std::string directory_;
  std::uint64_t offset_ = 0;
  std::uint64_t count_ = 0;
};

}  // namespace sherd
