// DIR/.sherd-partial: a fracture that is being moved into the folder DIR.
//
//     DIR/.sherd-partial/new/...       the new fracture, its manifest.json written last
//     DIR/.sherd-partial/old/...       the old fracture, while the new one is moved into DIR
//     DIR/.sherd-partial/made/meshes   an empty folder: DIR/meshes was made for the new fracture
//
// After a kill at any system call, the files on the disk determine the recovery
// (docs/decisions/0015-a-folder-survives-kill.md):
//
//     DIR/manifest.json exists     the fracture in DIR is complete: .sherd-partial is removed
//     it does not exist            the moves are undone: files of new/manifest.json that are absent
//                                  from new/ are moved back there, then everything in old/ is moved
//                                  back into DIR, manifest.json last
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "base/files/unfinished.h"

namespace sherd {

/// Whether a path exists, broken links included.
[[nodiscard]] bool present(const std::filesystem::path& path);

/// An exclusive or shared lock of a folder.
class FolderLock {
 public:
  FolderLock() = default;
  explicit FolderLock(int descriptor) : descriptor_(descriptor) {}
  ~FolderLock();
  FolderLock(FolderLock&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}
  FolderLock& operator=(FolderLock&& other) noexcept {
    std::swap(descriptor_, other.descriptor_);
    return *this;
  }

  /// Makes the lock a shared one; waits while another process holds it exclusively.
  void share();

 private:
  int descriptor_ = -1;
};

/// The folder DIR/.sherd-partial, created and locked.  The kernel releases the lock when a process
/// dies, so the content of a folder that can be locked belongs to no running process.
class PartialFolder {
 public:
  /// Undoes what a killed run left in DIR, and empties .sherd-partial.
  ///   throws  Error(output) DIR cannot be written, another process holds the lock, or undoing
  ///           fails; no file is lost
  explicit PartialFolder(const std::filesystem::path& folder);
  ~PartialFolder();  ///< removes it
  PartialFolder(const PartialFolder&) = delete;
  PartialFolder& operator=(const PartialFolder&) = delete;

  /// The folder for the new fracture's files.
  [[nodiscard]] std::filesystem::path fresh() const;

  /// Moves the old fracture from DIR to .sherd-partial/old and the new one into DIR, completely or
  /// not at all.
  ///   old     files of the old fracture, without the manifest
  ///   fresh   files of the new fracture, without the manifest
  ///   throws  Error(output); DIR is restored, now or when the next process opens it
  void putInPlace(const std::vector<std::string>& old, const std::vector<std::string>& fresh);

  /// Undoes putInPlace(), with the same files.
  ///   throws  Error(output) if that fails; the message describes the state of DIR
  void takeBack(const std::vector<std::string>& fresh);

  /// Makes putInPlace() final; only .sherd-partial remains to be removed.  If this process ends
  /// before that, the next process that opens the folder removes it.
  void keep();

 private:
  void leave() noexcept;

  std::filesystem::path folder_;
  std::filesystem::path path_;
  FolderLock lock_;
  Unfinished unfinished_;
  bool leave_ = false;  // to the next process
};

}  // namespace sherd
