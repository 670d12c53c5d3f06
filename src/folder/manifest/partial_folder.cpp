// Moves a fracture into its folder so that a killed run can be undone.
#include "folder/manifest/partial_folder.h"

#include <fcntl.h>
#include <sherd/error.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <thread>
#include <utility>

#include "base/files/atomic_file.h"
#include "base/files/below_folder.h"
#include "base/files/folders.h"
#include "base/input_error.h"
#include "folder/manifest/file_names.h"
#include "folder/manifest/listed_files.h"
#include "folder/manifest/own_files.h"

namespace sherd {
namespace {

namespace fs = std::filesystem;

using Files = std::vector<std::string>;

constexpr const char* kNew = "new";
constexpr const char* kOld = "old";
constexpr const char* kMade = "made";

constexpr const char* kRestores = "; the next run, or sherd inspect, restores the earlier fracture";

// ---- Folders and renames

// Returns the subfolders of a root that have files: one level, as in fileNames.
std::set<fs::path> subfoldersOf(const fs::path& root, const Files& files) {
  std::set<fs::path> folders;
  for (const std::string& file : files) {
    const fs::path parent = fs::path(file).parent_path();
    if (!parent.empty()) folders.insert(root / parent);
  }
  return folders;
}

void makeFolders(const fs::path& root, const Files& files) {
  makeFolder(root);
  for (const fs::path& folder : subfoldersOf(root, files)) makeFolder(folder);
}

void removeEmpty(const std::set<fs::path>& folders) {
  for (const fs::path& folder : folders) ::rmdir(folder.c_str());  // fails if it is not empty
}

// Removes the folders that were created for a fracture that was not moved.
void removeMade(const fs::path& folder, const fs::path& partial) {
  std::error_code none;
  for (fs::directory_iterator at(partial / kMade, none), end; !none && at != end;
       at.increment(none)) {
    ::rmdir((folder / at->path().filename()).c_str());
  }
}

// Renames without replacing a file, which could be a user's.
int renameOntoNothing(const fs::path& from, const fs::path& to) {
  if (::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0) return 0;
  if (errno != EINVAL && errno != ENOSYS) return errno;
  if (present(to)) return EEXIST;  // the file system lacks RENAME_NOREPLACE
  return ::rename(from.c_str(), to.c_str()) == 0 ? 0 : errno;
}

void move(const fs::path& from, const fs::path& to) {
  const int failed = renameOntoNothing(from, to);
  if (failed != 0) outputError(to, "cannot be put in place: " + reasonOf(failed));
}

// ---- Undoing moves

// The content of .sherd-partial/new or .sherd-partial/old by its manifest.
struct Side {
  bool manifest = false;
  Files files;
};

Side sideOf(const fs::path& partial, const char* name) {
  const fs::path file = partial / name / kManifestName;
  if (!isFolder(partial / name) || !present(file)) return {};
  const std::optional<nlohmann::json> json = manifestJson(file);
  std::optional<OwnFiles> files = json ? ownFiles(*json) : std::nullopt;
  if (!files) {
    outputError(file,
                "is not a manifest of a fracture, so what a killed run left is not undone; "
                "move " +
                    partial.string() + " away");
  }
  return {true, std::move(files->own)};
}

// Returns all files below a folder except its manifest, relative to it, without following links.
std::vector<fs::path> filesBelow(const fs::path& root) {
  std::vector<fs::path> files;
  if (!isFolder(root)) return files;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root)) {
    if (isFolder(entry.path())) continue;
    fs::path file = entry.path().lexically_relative(root);
    if (file != kManifestName) files.push_back(std::move(file));
  }
  return files;
}

// Undoes a partial putInPlace or a partial moveBack.  A file in the folder belongs to the new
// fracture if it is absent from new/, which had all of them.  Everything in old/ is moved back,
// whatever its name: only a run puts files there, and version 0.1 moved all files that its manifest
// listed.
void moveBack(const fs::path& folder, const fs::path& partial, const Files& fresh) {
  const Uncut whole;
  const fs::path newSide = partial / kNew, oldSide = partial / kOld;
  for (const std::string& file : fresh) {
    if (present(newSide / file) || typeOf(folder / file) != fs::file_type::regular) continue;
    move(folder / file, newSide / file);
  }
  for (const fs::path& file : filesBelow(oldSide)) {
    requireOwnSubfolder(folder, file.string());
    fs::create_directories((folder / file).parent_path());
    move(oldSide / file, folder / file);
  }
  removeMade(folder, partial);
  if (isFolder(oldSide) && present(oldSide / kManifestName)) {
    move(oldSide / kManifestName, folder / kManifestName);
  }
}

// Removes the content of .sherd-partial, each manifest before the files that it lists, so that a
// manifest never lists removed files.
void clear(const fs::path& partial) {
  for (const char* side : {kNew, kOld}) {
    if (isFolder(partial / side)) ::unlink((partial / side / kManifestName).c_str());
  }
  std::vector<fs::path> inside;
  for (const fs::directory_entry& entry : fs::directory_iterator(partial)) {
    inside.push_back(entry.path());
  }
  for (const fs::path& path : inside) fs::remove_all(path);
}

// Undoes what a killed run left.  The caller holds the lock.
void undo(const fs::path& folder, const fs::path& partial) {
  const bool isWhole = present(folder / kManifestName);
  if (!isWhole) {
    const Side fresh = sideOf(partial, kNew);
    (void)sideOf(partial, kOld);  // throws if it is not a fracture's
    for (const fs::path& root : {folder, partial / kNew}) {
      for (const std::string& file : fresh.files) requireOwnSubfolder(root, file);
    }
    moveBack(folder, partial, fresh.files);
  } else if (isFolder(partial / kOld)) {  // killed after the last move: empty folders may be left
    const std::optional<nlohmann::json> json = manifestJson(partial / kOld / kManifestName);
    const std::optional<OwnFiles> files = json ? ownFiles(*json) : std::nullopt;
    if (files) removeEmpty(subfoldersOf(folder, files->own));
  }
  removeMade(folder, partial);  // or killed before the first move
  clear(partial);
}

// ---- The lock

// Opens and locks the folder.
//   return  nothing on failure, with errno: EWOULDBLOCK if another process holds the lock
std::optional<FolderLock> locked(const fs::path& partial) {
  const int descriptor = ::open(partial.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (descriptor < 0) return {};
  struct stat held {
  }, named{};
  int failed = ::flock(descriptor, LOCK_EX | LOCK_NB) == 0 ? 0 : errno;
  if (failed == 0 && (::fstat(descriptor, &held) != 0 || ::lstat(partial.c_str(), &named) != 0 ||
                      held.st_ino != named.st_ino)) {
    failed = ENOENT;  // the previous holder has just removed it
  }
  if (failed == 0) return FolderLock(descriptor);
  ::close(descriptor);
  errno = failed;
  return {};
}

FolderLock madeAndLocked(const fs::path& folder, const fs::path& partial) {
  for (;;) {
    if (::mkdir(partial.c_str(), 0777) != 0 && errno != EEXIST) {
      outputError(folder, "cannot be written: " + reasonOf(errno));
    }
    if (std::optional<FolderLock> lock = locked(partial)) return std::move(*lock);
    if (errno == ENOENT) continue;
    if (errno == EWOULDBLOCK) {
      outputError(folder, "another sherd is writing there; wait for it or name another folder");
    }
    if (errno == ENOTDIR || errno == ELOOP) outputError(partial, "is not a folder; move it away");
    outputError(partial, "cannot be opened: " + reasonOf(errno));
  }
}

}  // namespace

bool present(const fs::path& path) {
  return fs::symlink_status(path).type() != fs::file_type::not_found;
}

FolderLock::~FolderLock() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void FolderLock::share() {
  while (descriptor_ >= 0 && ::flock(descriptor_, LOCK_SH) != 0 && errno == EINTR) {
  }
}

PartialFolder::PartialFolder(const fs::path& folder)
    : folder_(folder), path_(folder / kPartialName) {
  {
    const Uncut whole;
    lock_ = madeAndLocked(folder_, path_);
    // Not yet Kind::folder: what a killed run left must first be undone.
    unfinished_ = Unfinished(path_, Unfinished::Kind::madeFolder);
  }
  try {
    undo(folder_, path_);
    unfinished_ = Unfinished(path_, Unfinished::Kind::folder);
  } catch (...) {
    ::rmdir(path_.c_str());  // fails if it is not empty
    throw;
  }
}

PartialFolder::~PartialFolder() {
  if (leave_) return;
  try {
    clear(path_);
  } catch (const std::exception&) {
    // The next process that opens it removes it.
  }
  ::rmdir(path_.c_str());
}

fs::path PartialFolder::fresh() const { return path_ / kNew; }

void PartialFolder::putInPlace(const Files& old, const Files& fresh) {
  const Uncut whole;  // only renames, which do not block
  const fs::path newSide = path_ / kNew, oldSide = path_ / kOld;
  const std::set<fs::path> emptied = subfoldersOf(folder_, old);
  makeFolders(oldSide, old);
  makeFolder(path_ / kMade);
  try {
    for (const fs::path& subfolder : subfoldersOf(folder_, fresh)) {
      if (isFolder(subfolder)) continue;
      makeFolder(path_ / kMade / subfolder.filename());
      makeFolder(subfolder);
    }
    if (present(folder_ / kManifestName)) {
      move(folder_ / kManifestName, oldSide / kManifestName);
    }
    for (const std::string& file : old) {
      const fs::file_type type = typeOf(folder_ / file);
      if (type == fs::file_type::regular || type == fs::file_type::symlink) {
        move(folder_ / file, oldSide / file);
      }
    }
    for (const std::string& file : fresh) move(newSide / file, folder_ / file);
    move(newSide / kManifestName, folder_ / kManifestName);
  } catch (const std::exception& failed) {
    try {
      moveBack(folder_, path_, fresh);
    } catch (const std::exception&) {
      leave();
      throw Error(ErrorCode::output, std::string(failed.what()) + kRestores);
    }
    throw;
  }
  removeEmpty(emptied);  // the new fracture is complete: errors are ignored
}

void PartialFolder::takeBack(const Files& fresh) {
  const Uncut whole;
  try {
    move(folder_ / kManifestName, path_ / kNew / kManifestName);
  } catch (const Error& failed) {
    leave();
    throw Error(failed.code(), std::string(failed.what()) + "; it holds the new fracture",
                failed.options());
  }
  try {  // without its manifest the new fracture is unfinished
    moveBack(folder_, path_, fresh);
  } catch (const std::exception& failed) {
    leave();
    throw Error(ErrorCode::output, std::string(failed.what()) + kRestores);
  }
}

void PartialFolder::leave() noexcept {
  leave_ = true;
  unfinished_.end();
}

void PartialFolder::keep() { unfinished_.end(); }

// ---- Before a fracture is read

namespace {

constexpr std::chrono::milliseconds kPatience(1000), kBetweenTries(20);

// The same, but waits for other readers, which hold the lock only for a moment.
std::optional<FolderLock> patientlyLocked(const fs::path& partial) {
  const auto begin = std::chrono::steady_clock::now();
  for (;;) {
    std::optional<FolderLock> lock = locked(partial);
    const bool isHeld = !lock && errno == EWOULDBLOCK;
    if (!isHeld) return lock;
    if (std::chrono::steady_clock::now() - begin > kPatience) {
      errno = EWOULDBLOCK;
      return {};
    }
    std::this_thread::sleep_for(kBetweenTries);
  }
}

// The caller holds the lock.
void settle(const fs::path& folder, const fs::path& partial) {
  if (present(folder / kManifestName)) return;  // the writer has just finished
  if (sideOf(partial, kOld).manifest) {
    undo(folder, partial);
    ::rmdir(partial.c_str());
  } else if (sideOf(partial, kNew).manifest) {
    inputError(folder, "holds no finished fracture, as the run was killed; break the mesh again");
  }
}

void requireSettledFolder(const fs::path& folder) {
  const fs::path partial = folder / kPartialName;
  if (present(folder / kManifestName) || !isFolder(partial)) return;
  const std::optional<FolderLock> lock = patientlyLocked(partial);
  if (!lock) {
    if (errno == ENOENT) return;  // the holder has just finished
    if (errno == EWOULDBLOCK) inputError(folder, "another sherd is writing there; wait for it");
    inputError(partial, "cannot be opened: " + reasonOf(errno));
  }
  try {
    settle(folder, partial);
  } catch (const Error& e) {
    if (e.code() != ErrorCode::output) throw;
    inputError(folder,
               std::string("a killed run left its fracture half replaced, which cannot be "
                           "undone: ") +
                   e.what(),
               e.options());
  } catch (const fs::filesystem_error& e) {
    if (present(folder / kManifestName)) return;  // restored; only the cleanup failed
    inputError(folder,
               "holds what a killed run left, which cannot be read: " + reasonOf(e.code().value()));
  }
}

}  // namespace

void requireSettled(const fs::path& path) {
  try {
    fs::path folder = path;
    if (path.filename() == kManifestName) {
      folder = path.has_parent_path() ? path.parent_path() : ".";
    }
    if (!isFolder(folder / ".")) return;
    requireSettledFolder(folder);
    const fs::path real = fs::canonical(folder);
    if (isSubfolder(real.filename().string())) requireSettledFolder(real.parent_path());
  } catch (const fs::filesystem_error&) {
    // The reader reports what cannot be accessed.
  }
}

}  // namespace sherd
