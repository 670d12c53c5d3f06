// Checks of paths below a folder.
#include "base/files/below_folder.h"

#include <sherd/error.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

#include "base/files/atomic_file.h"
#include "base/input_error.h"

namespace sherd {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLongestPart = 255, kLongestPath = 4000;  // bytes, limits of file systems

[[noreturn]] void inTheWay(const fs::path& path, const char* wanted) {
  throw Error(ErrorCode::output, path.string() + ": is not a " + wanted +
                                     "; move it away or name another output folder");
}

// Returns the type of a path's entry without following links.
fs::file_type typeOf(const fs::path& path) {
  std::error_code failed;
  const fs::file_type type = fs::symlink_status(path, failed).type();
  if (type != fs::file_type::none) return type;
  throw Error(ErrorCode::output,
              path.string() + ": cannot be accessed: " + reasonOf(failed.value()));
}

}  // namespace

bool isBelowFolder(const std::string& name) {
  const fs::path path = name;
  if (name.find('\0') != std::string::npos || name.size() > kLongestPath) return false;
  if (path.empty() || path.is_absolute() || !path.has_filename()) return false;
  return std::none_of(path.begin(), path.end(), [](const fs::path& part) {
    return part == ".." || part == "." || part.native().size() > kLongestPart;
  });
}

bool staysWithin(const fs::path& folder, const fs::path& name) {
  const fs::path named = folder.empty() ? fs::path(".") : folder;
  std::error_code error;
  const fs::path root = fs::canonical(named, error);
  const fs::path real = error ? root : fs::weakly_canonical(named / name, error);
  if (error) inputError(named / name, "cannot be read: " + error.message());
  return std::mismatch(root.begin(), root.end(), real.begin(), real.end()).first == root.end();
}

void requireOwnSubfolder(const fs::path& folder, const std::string& file) {
  fs::path at = folder;
  for (const fs::path& part : fs::path(file).parent_path()) {
    at /= part;
    const fs::file_type type = typeOf(at);
    if (type == fs::file_type::not_found) return;
    if (type != fs::file_type::directory) inTheWay(at, "folder");
  }
}

void requireOwnFile(const fs::path& folder, const std::string& file) {
  requireOwnSubfolder(folder, file);
  const fs::file_type type = typeOf(folder / file);
  if (type != fs::file_type::not_found && type != fs::file_type::regular) {
    inTheWay(folder / file, "regular file");
  }
}

bool isOwnFile(const fs::path& folder, const std::string& file) {
  std::error_code none;
  fs::path at = folder;
  for (const fs::path& part : fs::path(file).parent_path()) {
    at /= part;
    if (!fs::is_directory(fs::symlink_status(at, none))) return false;
  }
  return fs::is_regular_file(fs::symlink_status(folder / file, none));
}

void removeOwnFile(const fs::path& folder, const std::string& file) {
  if (!isOwnFile(folder, file)) return;
  if (::unlink((folder / file).c_str()) == 0 || errno == ENOENT) return;
  throw Error(ErrorCode::output,
              (folder / file).string() + ": cannot be removed: " + reasonOf(errno));
}

}  // namespace sherd
