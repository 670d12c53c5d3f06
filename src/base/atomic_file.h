// Files that appear whole or not at all.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "base/unfinished.h"

namespace sherd {

/// Whether what is written stays in the system's cache.
enum class Caching {
  kept,
  none  ///< as far as the file system can, and memory is aligned to kDirectBlock: for more than
        ///< fits, as finding room in the cache costs more than all else that writing takes
};

constexpr std::size_t kDirectBlock = 4096;

/// A file written beside its final name, under a hidden one, and renamed by commit().  Until then
/// the target is untouched; without commit() nothing is left.  The target must be absent or a
/// regular file: renaming onto a device or a symbolic link would replace it.
class AtomicFile {
 public:
  /// throws  Error(output) the target is something else, or its folder cannot be written
  explicit AtomicFile(std::filesystem::path file, Caching caching = Caching::kept);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  /// Append; hand over large pieces, there is no buffer.
  ///   throws  Error(output) the disk is full or the like, with the bytes that went well
  void write(std::string_view bytes);

  /// Nothing follows.
  ///   throws  Error(output)
  void close();

  /// Close, and give the file its name.
  ///   throws  Error(output)
  void commit();

  /// The same, undone unless kept: what was there before lies beside until then, under a hidden
  /// name.  To be within an Uncut until it is kept.
  ///   throws  Error(output), and all is as it was
  void putInPlace();
  void keep();

  /// Undo that.
  ///   return  what there is where it cannot be undone, in the middle of a sentence; else nothing
  [[nodiscard]] std::string takeBack();

 private:
  [[noreturn]] void fail(int number) const;
  void put(std::string_view bytes, bool direct);
  void replaceByTwoRenames();
  bool undo() noexcept;

  std::filesystem::path file_;
  std::filesystem::path temporary_;
  std::filesystem::path before_;  // what was there, once it is in place
  bool isInPlace_ = false;        // and not kept
  Unfinished unfinished_;
  int descriptor_ = -1;
  std::uintmax_t written_ = 0;
  Caching caching_;
};

/// Write `bytes` as the whole of a file.
void writeWhole(const std::filesystem::path& file, std::string_view bytes);

/// Whether a file of this name is one that is being written, or that a killed run left.
[[nodiscard]] bool isTemporaryName(std::string_view name);

/// What an errno value means, in the middle of a sentence: "no space left on device".
[[nodiscard]] std::string reasonOf(int number);

}  // namespace sherd
