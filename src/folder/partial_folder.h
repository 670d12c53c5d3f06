// DIR/.sherd-partial: a fracture on its way into the folder DIR.
//
//     DIR/.sherd-partial/new/...       the new fracture, its manifest.json written last
//     DIR/.sherd-partial/old/...       the old one, set aside while the new one is moved into DIR
//     DIR/.sherd-partial/made/meshes   an empty folder: DIR/meshes was made for the new fracture
//
// What is on the disk says at every system call how to go on after a kill
// (docs/decisions/0015-a-folder-survives-kill.md):
//
//     DIR/manifest.json is there   the fracture in DIR is whole: .sherd-partial is removed
//     it is not                    the moves are undone: files of new/manifest.json that are not in
//                                  new/ go back there, then all that is in old/ goes back into DIR,
//                                  manifest.json last
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "base/unfinished.h"

namespace sherd {

/// Whether anything has this name, be it a link that leads nowhere.
[[nodiscard]] bool present(const std::filesystem::path& path);

/// A folder that one process at a time holds, or several share.
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

  /// Let others hold it as well that share it, and wait for those that do not.
  void share();

 private:
  int descriptor_ = -1;
};

/// The folder DIR/.sherd-partial, made and locked.  The kernel unlocks it when a process dies, so
/// what is in one that can be locked is nobody's.
class PartialFolder {
 public:
  /// Undo what a killed run left in DIR, and empty .sherd-partial.
  ///   throws  Error(output) DIR cannot be written, another process holds it, or what was left
  ///           cannot be undone; then nothing is lost
  explicit PartialFolder(const std::filesystem::path& folder);
  ~PartialFolder();  ///< removes it
  PartialFolder(const PartialFolder&) = delete;
  PartialFolder& operator=(const PartialFolder&) = delete;

  /// Where the new fracture is to be written.
  [[nodiscard]] std::filesystem::path fresh() const;

  /// Move the fracture in fresh() into DIR, and that in DIR aside.  All of it or nothing.
  ///   old    the files in DIR that go, without the manifest
  ///   fresh  those in fresh() that come, without the manifest
  ///   throws  Error(output); DIR is as it was then, or will be when the next process has opened it
  void putInPlace(const std::vector<std::string>& old, const std::vector<std::string>& fresh);

  /// Undo that, with the same files.
  ///   throws  Error(output) where it cannot be undone, with what DIR holds then
  void takeBack(const std::vector<std::string>& fresh);

  /// It is not to be undone, and what is left is to remove .sherd-partial.  The next process that
  /// opens the folder does so where this one is ended before.
  void keep();

 private:
  void leave() noexcept;

  std::filesystem::path folder_;
  std::filesystem::path path_;
  FolderLock lock_;
  Unfinished unfinished_;
  bool leave_ = false;  // to the next process
};

/// Before a fracture is read: see that no killed run left it half replaced, and undo that where one
/// did.  A folder with a manifest is left alone.
///   path    the fracture's folder, one of its sub-folders, or its manifest; of any other there is
///           nothing to see
///   throws  Error(input) it cannot be undone, another process writes there, or the fracture was
///           never finished
void requireSettled(const std::filesystem::path& path);

}  // namespace sherd
