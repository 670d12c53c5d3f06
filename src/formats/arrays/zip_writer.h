// Writes ZIP files.
#pragma once

#include <sherd/files.h>

#include <cstdint>
#include <string>
#include <string_view>

namespace sherd {

/// A file packed for a ZIP file, without a timestamp: equal files give equal bytes.
struct PackedFile {
  std::string name;
  bool deflated = false;
  std::uint32_t sum = 0;   ///< CRC-32 of the unpacked bytes
  std::uint64_t size = 0;  ///< unpacked
  std::string bytes;       ///< packed
};

[[nodiscard]] PackedFile packed(std::string name, bool deflate, const Content& content);

/// The same, with the packed bytes passed to a sink instead of PackedFile::bytes.
[[nodiscard]] PackedFile packed(std::string name, bool deflate, const Content& content,
                                const ByteSink& to);

/// Adds bytes of a stored file to its sum and its size.
void addStored(PackedFile& file, std::string_view bytes);

/// Writes a ZIP file, one packed file after another; uses ZIP64 where 32 bits are too few.
class ZipWriter {
 public:
  ///   alignment  of each added file's bytes in the output, as USDZ needs 64; 1: none
  explicit ZipWriter(ByteSink sink, std::uint64_t alignment = 1)
      : sink_(std::move(sink)), alignment_(alignment) {}

  void add(const PackedFile& file);

  /// Writes what precedes the bytes of a file, which the caller writes.
  ///   file  its `bytes` are ignored
  ///   size  packed bytes
  void begin(const PackedFile& file, std::uint64_t size);

  /// Records a file that is already at the end of the output.
  ///   file  its `bytes` are ignored
  ///   size  packed bytes
  void note(const PackedFile& file, std::uint64_t size);

  /// Writes the directory, which ends the ZIP file.
  void finish();

  /// Bytes written so far, with those that follow a begin().
  [[nodiscard]] std::uint64_t offset() const { return offset_; }

 private:
  // Records a file behind a local header with `localExtra` bytes of extra fields.
  void note(const PackedFile& file, std::uint64_t size, std::size_t localExtra);

  ByteSink sink_;
  std::uint64_t alignment_;
  std::string directory_;
  std::uint64_t offset_ = 0;
  std::uint64_t count_ = 0;
};

}  // namespace sherd
