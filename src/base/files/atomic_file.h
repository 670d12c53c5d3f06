// Atomically written files.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "base/files/direct_io.h"
#include "base/files/unfinished.h"

namespace sherd {

/// Whether written data stays in the system's cache.
enum class Caching {
  kept,
  none  ///< direct I/O where the file system supports it and memory is aligned to kDirectBlock; for
        ///< data larger than the cache, where evicting pages costs more than writing
};

/// A file written under a hidden temporary name in the target's folder and renamed by commit().
/// Until then the target does not change; without commit() the temporary is removed.  The target
/// must be absent or a regular file: renaming onto a device or a symbolic link would replace it.
class AtomicFile {
 public:
  ///   throws  Error(output) the target is something else, or its folder cannot be written
  explicit AtomicFile(std::filesystem::path file, Caching caching = Caching::kept);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  /// Appends without a buffer: pass large chunks.
  ///   throws  Error(output) write error such as a full disk, with the number of bytes written
  void write(std::string_view bytes) { write(std::span(&bytes, 1)); }

  /// The same for several pieces of memory, in as few calls of the system as possible.  Direct I/O
  /// needs all but the last to be multiples of kDirectBlock.
  void write(std::span<const std::string_view> pieces);

  /// Returns the path of the temporary, for a library that opens files by their names.
  [[nodiscard]] const std::filesystem::path& temporary() const { return temporary_; }

  /// Ends writing.
  ///   throws  Error(output)
  void close();

  /// Closes the file and renames it to the target.
  ///   throws  Error(output)
  void commit();

  /// The same, but the destructor undoes it unless keep() is called: until then the replaced file
  /// stays in the folder under a hidden name.  Call both within one Uncut.
  ///   throws  Error(output), the target is unchanged
  void putInPlace();
  void keep();

  /// Undoes putInPlace().
  ///   return  if that fails, the resulting state as a clause of a sentence; else empty
  [[nodiscard]] std::string takeBack();

 private:
  [[noreturn]] void fail(int number) const;
  void put(std::span<const std::string_view> pieces, bool direct);
  void replaceByTwoRenames();
  bool undo() noexcept;

  std::filesystem::path file_;
  std::filesystem::path temporary_;
  std::filesystem::path before_;  // the replaced file, after putInPlace()
  bool isInPlace_ = false;        // after putInPlace(), before keep()
  Unfinished unfinished_;
  int descriptor_ = -1;
  std::uintmax_t written_ = 0;
  Caching caching_;
};

/// Writes a file with the content `bytes`.
void writeWhole(const std::filesystem::path& file, std::string_view bytes);

/// Whether a name is that of an AtomicFile's temporary, in use or left by a killed run.
[[nodiscard]] bool isTemporaryName(std::string_view name);

/// Returns the description of an errno value in lower case: "no space left on device".
[[nodiscard]] std::string reasonOf(int number);

}  // namespace sherd
