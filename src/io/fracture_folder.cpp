// A fracture's folder: written aside, then moved into place.
//
//     DIR/.sherd-partial/new/...     everything new, its manifest.json written last
//     DIR/.sherd-partial/old/...     everything old, its manifest.json moved away first
//
// A run that was killed leaves .sherd-partial behind.  It marks the folder as ours, and its
// manifests say which of the folder's files are.
#include "io/fracture_folder.h"

#include <fcntl.h>
#include <sherd/error.h>
#include <sherd/io.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "io/atomic_file.h"
#include "io/below_folder.h"
#include "io/read_manifest.h"
#include "io/unfinished.h"

namespace sherd {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void outputError(const fs::path& path, const std::string& what) {
  throw Error(ErrorCode::output, path.string() + ": " + what);
}

// ---- What is in the folder already

bool present(const fs::path& path) {
  return fs::symlink_status(path).type() != fs::file_type::not_found;
}

// The files of the fracture that is in the folder now; empty where there is none.
std::vector<std::string> presentFiles(const fs::path& folder) {
  const auto manifest = manifestJson(folder / kManifestName);
  if (!manifest) return {};
  auto files = listedFiles(*manifest);
  if (!files) {
    outputError(folder / kManifestName,
                "lists files that are not below its folder, so nothing is replaced; "
                "name an absent or empty folder");
  }
  return *files;
}

void requireOurs(const fs::path& folder) {
  if (present(folder / kPartialName)) return;
  const std::optional<nlohmann::json> manifest = manifestJson(folder / kManifestName);
  if (manifest) {
    (void)presentFiles(folder);
    return;
  }
  std::set<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    names.insert(entry.path().filename().string());
  }
  if (names.empty()) return;
  outputError(folder, "holds '" + *names.begin() +
                          "' and no manifest of a fracture; name an absent or empty folder");
}

// Only making something tells whether something can be made.
void requireWritable(const fs::path& folder) {
  const Uncut whole;
  std::string probe = (folder / ".sherd-probe-XXXXXX").string();
  if (::mkdtemp(probe.data()) == nullptr) {
    outputError(folder, "cannot be written: " + reasonOf(errno));
  }
  ::rmdir(probe.c_str());
}

void removeEmptyFolders(const fs::path& folder, const std::vector<std::string>& files) {
  std::set<fs::path, std::greater<>> parents;  // deeper ones first
  for (const std::string& file : files) {
    for (fs::path p = fs::path(file).parent_path(); !p.empty(); p = p.parent_path())
      parents.insert(p);
  }
  for (const fs::path& parent : parents)
    ::rmdir((folder / parent).c_str());  // fails where not empty
}

// ---- Writing aside

// Folders made where they were missing, taken away again unless kept.
class MadeFolders {
 public:
  MadeFolders() = default;
  ~MadeFolders() {
    for (auto p = made_.rbegin(); p != made_.rend(); ++p) ::rmdir(p->path.c_str());
  }
  MadeFolders(const MadeFolders&) = delete;
  MadeFolders& operator=(const MadeFolders&) = delete;

  void make(const fs::path& folder) {
    std::vector<fs::path> missing;
    for (fs::path p = folder; !p.empty() && !fs::exists(p); p = p.parent_path()) {
      if (p.has_filename()) missing.push_back(p);
    }
    made_.reserve(made_.size() + missing.size());
    for (auto p = missing.rbegin(); p != missing.rend(); ++p) {
      const Uncut whole;
      Made one{*p, {*p, Unfinished::Kind::madeFolder}};  // before, as memory may be out
      if (::mkdir(p->c_str(), 0777) == 0) {
        made_.push_back(std::move(one));
      } else if (errno != EEXIST) {
        outputError(*p, "cannot be made: " + reasonOf(errno));
      }
    }
  }
  void keep() { made_.clear(); }

 private:
  struct Made {
    fs::path path;
    Unfinished unfinished;
  };
  std::vector<Made> made_;
};

// DIR/.sherd-partial, held by one process at a time.  The kernel lets go of the lock when a process
// dies, so a folder that can be locked is nobody's: what an interrupted run left in it, or moved
// into DIR, is cleared away.
class PartialFolder {
 public:
  explicit PartialFolder(const fs::path& folder) : folder_(folder), path_(folder / kPartialName) {
    const Uncut whole;  // what an interrupted run left must not go before it is looked at
    lock();
    try {
      clearUnfinished();
      unfinished_ = Unfinished(path_, Unfinished::Kind::folder);
    } catch (...) {
      ::rmdir(path_.c_str());  // fails where something is in it
      ::close(descriptor_);
      throw;
    }
  }
  ~PartialFolder() {
    if (!keep_) {
      std::error_code ignored;
      fs::remove_all(path_, ignored);
    }
    unfinished_.end();
    ::close(descriptor_);
  }
  PartialFolder(const PartialFolder&) = delete;
  PartialFolder& operator=(const PartialFolder&) = delete;

  fs::path fresh() const { return path_ / "new"; }
  fs::path replaced() const { return path_ / "old"; }
  void keep() {
    keep_ = true;
    unfinished_.end();
  }

 private:
  void lock() {
    for (;;) {
      if (::mkdir(path_.c_str(), 0777) != 0 && errno != EEXIST) {
        outputError(folder_, "cannot be written: " + reasonOf(errno));
      }
      descriptor_ = ::open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
      if (descriptor_ < 0 && errno == ENOENT) continue;  // its last holder has just finished
      if (descriptor_ < 0) outputError(path_, "cannot be opened: " + reasonOf(errno));
      if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
        ::close(descriptor_);
        outputError(folder_, "another sherd is writing there; wait for it or name another folder");
      }
      struct stat held {
      }, named{};
      if (::fstat(descriptor_, &held) == 0 && ::stat(path_.c_str(), &named) == 0 &&
          held.st_ino == named.st_ino) {
        return;
      }
      ::close(descriptor_);
    }
  }

  void clearUnfinished() {
    if (!present(folder_ / kManifestName)) {
      for (const fs::path& side : {fresh(), replaced()}) {
        const auto manifest = manifestJson(side / kManifestName);
        const auto files = manifest ? listedFiles(*manifest) : std::nullopt;
        if (!files) continue;
        for (const std::string& file : *files) {
          requireOwnSubfolder(folder_, file);
          ::unlink((folder_ / file).c_str());
        }
        removeEmptyFolders(folder_, *files);
      }
    }
    fs::remove_all(fresh());
    fs::remove_all(replaced());
  }

  fs::path folder_;
  fs::path path_;
  Unfinished unfinished_;
  int descriptor_ = -1;
  bool keep_ = false;
};

// Renames that are undone unless kept.
class Moves {
 public:
  ~Moves() {
    for (auto m = done_.rbegin(); m != done_.rend(); ++m) {
      if (::rename(m->second.c_str(), m->first.c_str()) != 0) failed_ = true;
    }
    if (failed_) partial_.keep();  // the next run clears up by its manifests
  }
  explicit Moves(PartialFolder& partial) : partial_(partial) {}
  Moves(const Moves&) = delete;
  Moves& operator=(const Moves&) = delete;

  void move(const fs::path& from, const fs::path& to) {
    done_.emplace_back(from, to);  // before, as there may be no memory for it afterwards
    if (::rename(from.c_str(), to.c_str()) != 0) {
      const int reason = errno;
      done_.pop_back();
      outputError(to, "cannot be put in place: " + reasonOf(reason));
    }
  }
  void keep() { done_.clear(); }

 private:
  PartialFolder& partial_;
  std::vector<std::pair<fs::path, fs::path>> done_;
  bool failed_ = false;
};

void makeParents(const fs::path& root, const std::vector<std::string>& files) {
  const auto make = [](const fs::path& folder) {
    const Uncut whole;
    fs::create_directories(folder);
  };
  make(root);
  for (const std::string& file : files) make((root / file).parent_path());
}

// From here on nothing waits and nothing is asked: renames only, which are not cut.
void putInPlace(const fs::path& folder, PartialFolder& partial, const std::vector<std::string>& old,
                const std::vector<std::string>& fresh) {
  const Uncut whole;
  makeParents(partial.replaced(), old);
  MadeFolders subfolders;
  for (const std::string& file : fresh) subfolders.make((folder / file).parent_path());
  Moves moves(partial);
  if (present(folder / kManifestName))
    moves.move(folder / kManifestName, partial.replaced() / kManifestName);
  for (const std::string& file : old) {
    const fs::file_type type = fs::symlink_status(folder / file).type();
    if (type == fs::file_type::regular || type == fs::file_type::symlink) {
      moves.move(folder / file, partial.replaced() / file);
    }
  }
  for (const std::string& file : fresh) moves.move(partial.fresh() / file, folder / file);
  moves.move(partial.fresh() / kManifestName, folder / kManifestName);
  moves.keep();
  subfolders.keep();
  removeEmptyFolders(folder, old);
}

// Files are written aside, but a message names them where they will be.
std::string withoutAside(std::string message) {
  const std::string aside = std::string(kPartialName) + "/new/";
  const std::size_t at = message.find(aside);
  return at == std::string::npos ? message : message.erase(at, aside.size());
}

}  // namespace

void checkFractureFolder(const fs::path& folder) {
  try {
    if (folder.empty()) throw Error(ErrorCode::output, "the output folder has no name");
    if (fs::is_directory(folder)) {
      requireOurs(folder);
      requireWritable(folder);
      return;
    }
    if (present(folder)) outputError(folder, "is not a folder; name an absent or empty folder");
    fs::path parent = fs::absolute(folder).parent_path();
    while (!present(parent)) parent = parent.parent_path();
    if (!fs::is_directory(parent)) {
      outputError(folder, "cannot be made, because " + parent.string() + " is not a folder");
    }
    requireWritable(parent);
  } catch (const fs::filesystem_error& e) {
    outputError(folder, "cannot be used: " + reasonOf(e.code().value()));
  }
}

struct FractureReplacement::Parts {
  fs::path folder;
  std::vector<std::string> fresh;
  MadeFolders made;
  std::optional<PartialFolder> partial;
  std::vector<std::string> old;
};

namespace {

template <class Work>
auto withFolderErrors(const fs::path& folder, const Work& work) {
  try {
    return work();
  } catch (const Error& e) {
    throw Error(e.code(), withoutAside(e.what()));
  } catch (const fs::filesystem_error& e) {
    outputError(folder, "cannot be written: " + reasonOf(e.code().value()));
  }
}

}  // namespace

FractureReplacement::FractureReplacement(fs::path folder, std::vector<std::string> fresh)
    : parts_(std::make_unique<Parts>()) {
  parts_->folder = std::move(folder);
  parts_->fresh = std::move(fresh);
  checkFractureFolder(parts_->folder);
  withFolderErrors(parts_->folder, [this] {
    const fs::path& at = parts_->folder;
    parts_->made.make(at);
    parts_->partial.emplace(at);
    parts_->old = presentFiles(at);
    const std::set<std::string> ours(parts_->old.begin(), parts_->old.end());
    for (const std::string& file : parts_->old) requireOwnSubfolder(at, file);
    for (const std::string& file : parts_->fresh) {
      requireOwnSubfolder(at, file);
      if (present(at / file) && !ours.contains(file)) {
        outputError(at / file,
                    "is in the way and not an earlier fracture's; move it away or "
                    "name another output folder");
      }
    }
    makeParents(parts_->partial->fresh(), parts_->fresh);
  });
}

FractureReplacement::~FractureReplacement() = default;
FractureReplacement::FractureReplacement(FractureReplacement&& other) noexcept = default;
FractureReplacement& FractureReplacement::operator=(FractureReplacement&& other) noexcept = default;

void FractureReplacement::write(const std::function<void(const fs::path&)>& write) {
  withFolderErrors(parts_->folder, [&] { write(parts_->partial->fresh()); });
}

fs::path FractureReplacement::putInPlace() {
  return withFolderErrors(parts_->folder, [this] {
    sherd::putInPlace(parts_->folder, *parts_->partial, parts_->old, parts_->fresh);
    parts_->made.keep();
    parts_->partial.reset();
    return parts_->folder / kManifestName;
  });
}

}  // namespace sherd
