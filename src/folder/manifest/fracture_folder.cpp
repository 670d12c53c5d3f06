// Replaces a fracture's folder: files are written to a hidden folder, then moved
// (partial_folder.h).
#include <sherd/error.h>
#include <sherd/folder.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <new>
#include <nlohmann/json.hpp>
#include <set>
#include <system_error>
#include <utility>

#include "base/files/atomic_file.h"
#include "base/files/below_folder.h"
#include "base/files/folders.h"
#include "base/files/unfinished.h"
#include "base/text/text_scan.h"
#include "folder/manifest/own_files.h"
#include "folder/manifest/partial_folder.h"
#include "folder/manifest/read_manifest.h"

namespace sherd {
namespace {

namespace fs = std::filesystem;

// Out of memory is not an error of the folder.
[[noreturn]] void failedFolder(const fs::path& path, const std::string& what,
                               const fs::filesystem_error& e) {
  if (e.code() == std::errc::not_enough_memory) throw std::bad_alloc();
  outputError(path, what + ": " + reasonOf(e.code().value()));
}

// ---- The existing content of the folder

// Returns the files of the fracture in a folder; none if the folder is empty.
OwnFiles existingFiles(const fs::path& folder) {
  if (const std::optional<nlohmann::json> manifest = manifestJson(folder / kManifestName)) {
    std::optional<OwnFiles> files = ownFiles(*manifest);
    if (files) return std::move(*files);
    outputError(folder / kManifestName,
                "lists files that are not below its folder, so nothing is replaced; "
                "name an absent or empty folder");
  }
  std::set<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    names.insert(entry.path().filename().string());
  }
  names.erase(kPartialName);
  if (names.empty()) return {};
  outputError(folder, "holds '" + *names.begin() +
                          "' and no manifest of a fracture; name an absent or empty folder");
}

// Creates and removes a folder, the only reliable check.
void requireWritable(const fs::path& folder) {
  const Uncut whole;
  std::string probe = (folder / ".sherd-probe-XXXXXX").string();
  if (::mkdtemp(probe.data()) == nullptr) {
    outputError(folder, "cannot be written: " + reasonOf(errno));
  }
  ::rmdir(probe.c_str());
}

// ---- Writing to the hidden folder

// Creates missing folders; the destructor removes them unless they are kept.
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
      Made one{*p, {*p, Unfinished::Kind::madeFolder}};  // first, as it may throw bad_alloc
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

void makeParents(const fs::path& root, const std::vector<std::string>& files) {
  const auto make = [](const fs::path& folder) {
    const Uncut whole;
    fs::create_directories(folder);
  };
  make(root);
  for (const std::string& file : files) make((root / file).parent_path());
}

// Returns a warning about files that an earlier manifest lists under names that no fracture has.
std::vector<std::string> warningsOf(const fs::path& folder,
                                    const std::vector<std::string>& others) {
  constexpr std::size_t kMostNamed = 8;
  std::string named;
  std::size_t count = 0;
  for (const std::string& file : others) {
    std::error_code none;
    if (!fs::exists(fs::symlink_status(folder / file, none))) continue;
    if (++count <= kMostNamed) named += (named.empty() ? "" : ", ") + inQuotes(file);
  }
  if (count == 0) return {};
  if (count > kMostNamed) named += " and " + std::to_string(count - kMostNamed) + " more";
  return {folder.string() + ": the earlier manifest lists " + named + ", which " +
          (count == 1 ? "is not named as a fracture's file and stays"
                      : "are not named as a fracture's files and stay")};
}

// Removes the hidden folder from a message, so that it names a file's final path.
std::string withFinalPath(std::string message) {
  const std::string aside = std::string(kPartialName) + "/new/";
  const std::size_t at = message.find(aside);
  return at == std::string::npos ? message : message.erase(at, aside.size());
}

}  // namespace

void checkFractureFolder(const fs::path& folder) {
  try {
    if (folder.empty()) throw Error(ErrorCode::output, "the output folder has no name");
    if (fs::is_directory(folder)) {
      if (present(folder / kPartialName)) const PartialFolder undone(folder);
      (void)existingFiles(folder);
      const PartialFolder probe(folder);  // creates a folder, the only reliable check
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
    failedFolder(folder, "cannot be used", e);
  }
}

struct FractureReplacement::State {
  fs::path folder;
  std::vector<std::string> fresh;
  MadeFolders made;
  std::optional<PartialFolder> partial;
  std::vector<std::string> old;
  std::vector<std::string> warnings;
  bool isInPlace = false;  // after putInPlace(), before keep()
};

namespace {

template <class Work>
auto withFolderErrors(const fs::path& folder, const Work& work) {
  try {
    return work();
  } catch (const Error& e) {
    throw Error(e.code(), withFinalPath(e.what()), e.options());
  } catch (const fs::filesystem_error& e) {
    failedFolder(folder, "cannot be written", e);
  }
}

}  // namespace

FractureReplacement::FractureReplacement(fs::path folder, std::vector<std::string> fresh)
    : state_(std::make_unique<State>()) {
  state_->folder = std::move(folder);
  state_->fresh = std::move(fresh);
  checkFractureFolder(state_->folder);
  withFolderErrors(state_->folder, [this] {
    const fs::path& at = state_->folder;
    state_->made.make(at);
    state_->partial.emplace(at);
    OwnFiles listed = existingFiles(at);
    state_->old = std::move(listed.own);
    state_->warnings = warningsOf(at, listed.others);
    const std::set<std::string> ours(state_->old.begin(), state_->old.end());
    for (const std::string& file : state_->old) requireOwnSubfolder(at, file);
    for (const std::string& file : state_->fresh) {
      requireOwnSubfolder(at, file);
      if (present(at / file) && !ours.contains(file)) {
        outputError(at / file,
                    "is in the way and not an earlier fracture's; move it away or "
                    "name another output folder");
      }
    }
    makeParents(state_->partial->fresh(), state_->fresh);
  });
}

FractureReplacement::~FractureReplacement() {
  try {
    (void)takeBack();
  } catch (const std::exception&) {
    // Out of memory for the unused message.
  }
}
FractureReplacement::FractureReplacement(FractureReplacement&& other) noexcept = default;

std::string FractureReplacement::takeBack() {
  if (!state_ || !std::exchange(state_->isInPlace, false)) return {};
  try {
    state_->partial->takeBack(state_->fresh);
    return {};
  } catch (const Error& e) {
    return state_->folder.string() + " is not as it was before: " + e.what();
  }
}

void FractureReplacement::write(const std::function<void(const fs::path&)>& write) {
  withFolderErrors(state_->folder, [&] { write(state_->partial->fresh()); });
}

void FractureReplacement::warn(std::string sentence) {
  state_->warnings.push_back(std::move(sentence));
}

const std::vector<std::string>& FractureReplacement::warnings() const { return state_->warnings; }

void FractureReplacement::putInPlace() {
  withFolderErrors(state_->folder,
                   [this] { state_->partial->putInPlace(state_->old, state_->fresh); });
  state_->isInPlace = true;
}

fs::path FractureReplacement::keep() {
  return withFolderErrors(state_->folder, [this] {
    state_->isInPlace = false;
    state_->made.keep();
    state_->partial->keep();
    state_->partial.reset();
    return state_->folder / kManifestName;
  });
}

}  // namespace sherd
