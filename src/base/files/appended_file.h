// A file that grows at its end, past the system's cache.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "base/files/direct_io.h"

namespace sherd {

/// A file that grows at its end, by direct I/O where the file system supports it.  Its last bytes
/// wait in memory until they fill a buffer or flush() is called.
class AppendedFile {
 public:
  /// Opens or creates a file.  Call cutTo() before appending.
  ///   throws  Error(output), also for a symbolic link
  explicit AppendedFile(std::filesystem::path file);
  ~AppendedFile();
  AppendedFile(const AppendedFile&) = delete;
  AppendedFile& operator=(const AppendedFile&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  /// Reads bytes that are in the file.  Call it before cutTo().
  ///   return  fewer at its end
  ///   throws  Error(output)
  [[nodiscard]] std::string read(std::size_t bytes, std::uint64_t at) const;

  /// Cuts the file, so that appended bytes follow.
  ///   bytes   at most its size
  ///   throws  Error(output)
  void cutTo(std::uint64_t bytes);

  ///   throws  Error(output), as all of them
  void append(std::string_view bytes);

  /// Has all bytes in the file.  Zeros may follow them until close(), up to a multiple of
  /// kDirectBlock: the next bytes replace these.
  void flush();

  /// Flushes and closes the file, which then ends with the last byte.
  void close();

 private:
  [[noreturn]] void fail(int number) const;
  void put(std::string_view bytes);
  void seek(std::uint64_t at);

  std::filesystem::path path_;
  int descriptor_ = -1;
  DirectMemory buffer_;
  std::uint64_t begin_ = 0;  // position of the buffer in the file, a multiple of kDirectBlock
  std::size_t used_ = 0;     // bytes in the buffer
  bool isDirect_ = false;
};

}  // namespace sherd
