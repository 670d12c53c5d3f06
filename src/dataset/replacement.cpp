// A dataset that takes the place of another in the same folder.
#include "dataset/replacement.h"

#include <fcntl.h>
#include <sherd/error.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <thread>
#include <utility>

#include "base/files/atomic_file.h"
#include "base/files/folders.h"
#include "base/files/unfinished.h"
#include "dataset/journal/failure.h"
#include "dataset/journal/journal.h"
#include "dataset/journal/object_folder.h"
#include "dataset/replaced_files.h"

namespace sherd {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFolder = ".sherd-replacing";
constexpr const char* kNew = "new";
constexpr const char* kReady = "ready";
constexpr const char* kPlacing = "placing";
constexpr const char* kOld = "old";

void moveFolder(const fs::path& from, const fs::path& to) {
  if (::rename(from.c_str(), to.c_str()) != 0)
    outputError(to, "cannot be put in place: " + reasonOf(errno));
}

// Renames without replacing a file, which could be a user's.
void move(const fs::path& from, const fs::path& to) {
  int failed = 0;
  if (::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) != 0) {
    failed = errno;
    if (failed == EINVAL || failed == ENOSYS) {  // the file system lacks it
      const bool isTaken = typeOf(to) != fs::file_type::not_found;
      failed = isTaken ? EEXIST : ::rename(from.c_str(), to.c_str()) == 0 ? 0 : errno;
    }
  }
  if (failed == 0) return;
  outputError(to, "cannot be put in place: " + reasonOf(failed) +
                      "; the dataset is complete: run the same command again when that is mended");
}

std::set<std::string> entriesOf(const fs::path& folder) {
  std::set<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    names.insert(entry.path().filename().string());
  return names;
}

// Moves entries of a folder, its journals and plan last: they say what the others are.
void moveEntries(const fs::path& from, const fs::path& to, std::set<std::string> names) {
  std::vector<std::string> last;
  for (const char* name : {kJournalFolder, kPlanName}) {
    if (names.erase(name) > 0) last.emplace_back(name);
  }
  for (const std::string& name : names) move(from / name, to / name);
  for (const std::string& name : last) move(from / name, to / name);
}

// Locks the folder of the dataset against processes that work in it; they hold a shared lock.
FolderLock aloneIn(const fs::path& out) {
  constexpr int kTries = 100;
  constexpr std::chrono::milliseconds kBetween(20);
  const int descriptor = ::open(out.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  FolderLock lock(descriptor);
  for (int i = 0; i < kTries; ++i) {
    // A file system that cannot lock folders (NFS) has no lock to wait for.
    if (::flock(descriptor, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return lock;
    std::this_thread::sleep_for(kBetween);
  }
  outputError(out,
              "another sherd process works there, so the new dataset, which is complete, "
              "waits; run the same command again when it has ended");
}

}  // namespace

Replacement::Replacement(fs::path out, bool isShared)
    : out_(std::move(out)), path_(out_ / kFolder), isShared_(isShared) {
  makeFolder(path_);
  if (!isFolder(path_)) outputError(path_, "is not a folder; move it away");
  lock(isShared);
}

Replacement::~Replacement() {
  const Uncut whole;
  for (const char* name : {kNew, kOld}) ::rmdir((path_ / name).c_str());  // fails unless empty
  ::rmdir(path_.c_str());
}

void Replacement::lock(bool isShared) {
  if (descriptor_ < 0) {
    descriptor_ = ::open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    if (descriptor_ < 0) outputError(path_, "cannot be opened: " + reasonOf(errno));
    lock_ = FolderLock(descriptor_);
  }
  if (::flock(descriptor_, (isShared ? LOCK_SH : LOCK_EX) | LOCK_NB) == 0) return;
  if (errno == EWOULDBLOCK)
    outputError(out_, "another sherd process replaces the dataset there; wait for it to end");
}

fs::path Replacement::fresh() const { return path_ / kNew; }

bool Replacement::isPending() const {
  return isFolder(path_ / kReady) || isFolder(path_ / kPlacing) || isFolder(path_ / kOld);
}

void Replacement::discard() {
  lock(false);  // no other shard works there
  std::error_code failed;
  fs::remove_all(fresh(), failed);
  if (failed) outputError(fresh(), "cannot be removed: " + reasonOf(failed.value()));
  lock(isShared_);
}

void Replacement::prepare(const DatasetPlan& plan, const std::string& identity, int shards) {
  if (!isFolder(fresh())) return;
  bool isSame = false;
  try {
    const DatasetPlan before = readPlan(fresh());
    isSame = before.text == identity && before.layout == plan.layout;
  } catch (const Error&) {  // it was not begun, or is damaged
  }
  if (!isSame) return discard();
  if (const Leftovers leftovers = leftoversOf(fresh(), plan, shards); !leftovers.isEmpty()) {
    lock(false);
    removeLeftovers(fresh(), plan, leftovers);
    lock(isShared_);
  }
  for (const LibraryObject& object : plan.objects) {
    try {
      const JournalText journal = readJournal(fresh(), object);
      if (journal.sha256.empty() || journal.sha256 == sumOfObject(object)) continue;
    } catch (const Error&) {  // damaged
    }
    ::unlink((fresh() / journalName(object)).c_str());
  }
}

void Replacement::requireFree(const std::set<std::string>& entries) const {
  const std::set<std::string> old = entriesOfDataset(out_, readPlan(out_));
  for (const std::string& name : entries) {
    if (old.contains(name) || typeOf(out_ / name) == fs::file_type::not_found) continue;
    outputError(out_ / name,
                "is no file of the dataset there, and in the way of the new one; move "
                "it away and run the same command again");
  }
}

std::vector<std::string> Replacement::putInPlace() {
  lock(false);
  requireFree(entriesOf(fresh()));
  std::vector<std::string> sentences;
  {
    const FolderLock alone = aloneIn(out_);
    moveFolder(fresh(), path_ / kReady);
  }
  advance(sentences);
  return sentences;
}

void Replacement::advance(std::vector<std::string>& sentences) {
  {
    const FolderLock alone = aloneIn(out_);
    std::set<std::string> old;
    if (isFolder(path_ / kReady) && hasPlan(out_)) old = entriesOfDataset(out_, readPlan(out_));
    const Uncut whole;  // renames, which do not block
    if (isFolder(path_ / kReady)) {
      makeFolder(path_ / kOld);
      moveEntries(out_, path_ / kOld, std::move(old));
      moveFolder(path_ / kReady, path_ / kPlacing);
    }
    if (isFolder(path_ / kPlacing)) {
      moveEntries(path_ / kPlacing, out_, entriesOf(path_ / kPlacing));
      ::rmdir((path_ / kPlacing).c_str());
    }
  }
  if (isFolder(path_ / kOld)) sentences = removeDataset(path_ / kOld, out_);
}

bool hasReplacement(const fs::path& out) { return hasPlan(out / kFolder / kNew); }

bool finishReplacement(const fs::path& out, std::vector<std::string>& sentences) {
  const fs::path folder = out / kFolder;
  const auto has = [&](const char* name) { return isFolder(folder / name); };
  if (!isFolder(folder) || (!has(kReady) && !has(kPlacing) && !has(kOld))) return false;
  Replacement pending(out, false);
  if (!pending.isPending()) return false;
  pending.advance(sentences);
  return true;
}

}  // namespace sherd
