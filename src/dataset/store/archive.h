// The archive of an object's files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "base/files/appended_file.h"
#include "base/files/sha256.h"
#include "dataset/store/held_bytes.h"
#include "formats/arrays/zip_writer.h"

namespace sherd {

/// A ZIP file that grows by the files of one fracture after another.  Until finish() it has the
/// suffix of unfinished ones, and more bytes may follow those of the last flush().
class Archive {
 public:
  static constexpr const char* kSuffix = ".zip";
  static constexpr const char* kUnfinished = ".zip.partial";

  /// Opens an archive or creates one.
  ///   path    without suffix
  ///   kept    bytes of an earlier run to keep
  ///   throws  Error(output) it cannot be written, or does not have these bytes
  Archive(const std::filesystem::path& path, std::uint64_t kept);

  ///   file    its `bytes` are ignored
  ///   bytes   packed
  ///   throws  Error(output), as all of them
  void add(const PackedFile& file, const HeldBytes& bytes);

  /// Has all bytes in the file.
  void flush() { file_.flush(); }

  /// Bytes so far.
  [[nodiscard]] std::uint64_t bytes() const { return zip_.offset(); }

  struct Finished {
    std::uint64_t bytes = 0;
    std::string sha256;
  };
  /// Ends the archive and gives it its name.
  Finished finish();

 private:
  void append(std::string_view bytes);
  void readKept(std::uint64_t kept);
  void addToSum(std::string_view bytes);
  [[noreturn]] void damaged() const;

  std::filesystem::path final_;
  AppendedFile file_;
  std::uint64_t bytes_ = 0;  // of which sum_ is the sum
  Sha256 sum_;
  ZipWriter zip_{[this](std::string_view bytes) { append(bytes); }};
};

}  // namespace sherd
