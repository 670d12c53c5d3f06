// The output folder of a dataset.
#include "dataset/output_root.h"

#include <fcntl.h>
#include <sherd/error.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

#include "base/files/atomic_file.h"
#include "base/files/below_folder.h"
#include "dataset/index.h"
#include "dataset/journal/journal.h"
#include "dataset/journal/object_folder.h"
#include "dataset/layouts/hdf5_join.h"
#include "dataset/layouts/pfpp.h"
#include "dataset/layouts/split_of.h"

namespace sherd {
namespace {

namespace fs = std::filesystem;

// A path with all links resolved, as far as it exists.
fs::path resolved(const fs::path& path) {
  const fs::path whole = fs::absolute(path.has_filename() ? path : path.parent_path());
  std::error_code failed;
  const fs::path real = fs::weakly_canonical(whole, failed);
  return failed ? whole.lexically_normal() : real;
}

bool isWithin(const fs::path& path, const fs::path& folder) {
  return std::mismatch(folder.begin(), folder.end(), path.begin(), path.end()).first ==
         folder.end();
}

bool isTemporary(const fs::directory_entry& entry) {
  std::error_code none;
  return isTemporaryName(entry.path().filename().string()) &&
         entry.symlink_status(none).type() == fs::file_type::regular;
}

// Follows no link.  Files that cannot be read or removed stay.
template <class Iterator>
void removeTemporaries(const fs::path& folder) {
  std::error_code failed;
  if (fs::symlink_status(folder, failed).type() != fs::file_type::directory) return;
  for (Iterator at(folder, failed), end; !failed && at != end; at.increment(failed)) {
    if (isTemporary(*at)) ::unlink(at->path().c_str());
  }
}

}  // namespace

void requireApart(const fs::path& library, const std::vector<LibraryObject>& objects,
                  const fs::path& out) {
  const fs::path folder = resolved(out);
  const auto refuse = [&](const std::string& sentence) {
    throw Error(ErrorCode::usage,
                out.string() + ": " + sentence + "; name an output folder that lies apart");
  };
  if (fs::is_directory(library)) {
    const fs::path source = resolved(library);
    if (isWithin(folder, source)) refuse("lies in the library " + library.string());
    if (isWithin(source, folder)) refuse("holds the library " + library.string());
  }
  for (const LibraryObject& object : objects) {
    if (isWithin(resolved(object.file), folder)) refuse("holds " + object.key + " of the library");
  }
}

void requireNoLinks(const fs::path& out, const DatasetPlan& plan) {
  if (plan.layout == DatasetLayout::hdf5) {
    for (const char* end : {".hdf5", ".hdf5.json"})
      requireOwnFile(out, kHdf5Stem + std::string(end));
  }
  for (const LibraryObject& object : plan.objects) {
    requireOwnFile(out, journalName(object));
    const std::string folder = objectFolder(plan.layout, object);
    if (plan.layout == DatasetLayout::packed) {
      requireOwnFile(out, folder + ".zip");
    } else if (plan.layout == DatasetLayout::pfpp) {
      const PfppNames first = pfppNames(object, splitOf(object, plan.split), 0);
      requireOwnSubfolder(out, first.points);
      requireOwnSubfolder(out, first.matches);
    } else {
      requireOwnSubfolder(out, folder + "/file");
    }
  }
}

OutputLock::OutputLock(const fs::path& out) : out_(out) {
  const int descriptor = ::open(out.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  lock_ = FolderLock(descriptor);
  isAlone_ = ::flock(descriptor, LOCK_EX | LOCK_NB) == 0;
  if (!isAlone_) share();
}

void OutputLock::share() {
  if (isAlone_) {
    removeTemporaries<fs::directory_iterator>(out_);
    for (const char* folder : {kBbSplitFolder, kBbListFolder}) {
      removeTemporaries<fs::directory_iterator>(out_ / folder);
    }
    for (const char* folder : {kJournalFolder, kPfppPointFolder, kPfppMatchFolder}) {
      removeTemporaries<fs::recursive_directory_iterator>(out_ / folder);
    }
    isAlone_ = false;
  }
  lock_.share();
}

}  // namespace sherd
