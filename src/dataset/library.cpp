// The meshes of a library.
#include <fnmatch.h>
#include <sherd/dataset.h>
#include <sherd/error.h>
#include <sherd/files.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <numeric>
#include <utility>

#include "base/files/atomic_file.h"
#include "base/input_error.h"
#include "base/text/lower_case.h"
#include "base/text/printable.h"
#include "dataset/recipe/licenses.h"

namespace sherd {
namespace {

namespace fs = std::filesystem;

LibraryObject objectAt(const fs::path& file, std::string key) {
  std::error_code ignored;
  const std::uintmax_t bytes = fs::file_size(file, ignored);
  return {.key = std::move(key), .folder = {}, .file = file, .bytes = ignored ? 0 : bytes};
}

/// The objects below a folder, and a sentence for each skipped path.
struct Found {
  std::vector<LibraryObject>& objects;
  std::vector<std::string> skipped{};

  void skip(const fs::path& path, const std::string& why) {
    skipped.push_back(path.string() + ": " + why + ", and is skipped");
  }
};

void addEntry(const fs::directory_entry& entry, const fs::path& library, Found& found,
              std::vector<fs::path>& folders) {
  const fs::path& path = entry.path();
  if (path.filename().string().starts_with('.')) return;  // hidden
  std::error_code failed;
  const fs::file_type type = entry.symlink_status(failed).type();
  if (type == fs::file_type::directory) return folders.push_back(path);
  const bool isLink = type == fs::file_type::symlink;
  const fs::file_type target = isLink ? entry.status(failed).type() : type;
  if (isLink && target == fs::file_type::directory) {
    return found.skip(path, "is a link to a folder, which is not followed");
  }
  if (!isMeshName(path) && !isVolumeName(path)) return;
  if (target == fs::file_type::regular) {
    found.objects.push_back(objectAt(path, path.lexically_relative(library).generic_string()));
  } else if (target == fs::file_type::not_found) {
    found.skip(path, "is a broken link");
  } else if (target == fs::file_type::none) {
    found.skip(path, "cannot be examined: " + reasonOf(failed.value()));
  } else {
    found.skip(path, "is not a regular file");
  }
}

// Adds all objects below a folder.  A folder that cannot be read is skipped; the library's own is
// an error.
std::vector<std::string> addFolder(const fs::path& library, std::vector<LibraryObject>& objects) {
  Found found{objects};
  for (std::vector<fs::path> folders{library}; !folders.empty();) {
    const fs::path folder = folders.back();
    folders.pop_back();
    std::error_code failed;
    for (fs::directory_iterator at(folder, failed), end; !failed && at != end;
         at.increment(failed)) {
      addEntry(*at, library, found, folders);
    }
    if (!failed) continue;
    const std::string why = "cannot be read: " + reasonOf(failed.value());
    if (folder == library) inputError(library, why);
    found.skip(folder, why);
  }
  std::sort(found.skipped.begin(), found.skipped.end());
  return std::move(found.skipped);
}

void addList(const fs::path& list, std::vector<LibraryObject>& found) {
  std::ifstream in(list);
  if (!in) inputError(list, "cannot be read");
  std::size_t number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    if (line.ends_with('\r')) line.pop_back();
    if (line.empty() || line.starts_with('#')) continue;
    if (line.find('\0') != std::string::npos) {
      inputError(list, "is neither a mesh of a known format nor a text file of paths");
    }
    const fs::path named = fs::path(line).lexically_normal();
    const fs::path relative = named.relative_path();  // without the root of an absolute one
    if (relative.empty() || *relative.begin() == "..") {
      throw Error(ErrorCode::input, list.string() + ":" + std::to_string(number) +
                                        ": leads out of the list's folder; use an absolute path, "
                                        "or put the list above it");
    }
    found.push_back(objectAt(list.parent_path() / named, relative.generic_string()));
  }
}

std::string withoutExtensions(const std::string& key) {
  fs::path path(key);
  if (lowerCase(path.extension().string()) == ".gz") path.replace_extension();
  return path.replace_extension().generic_string();
}

void nameFolders(std::vector<LibraryObject>& objects) {
  // No object's folder equals or contains another's.
  std::map<std::string, int> taken;
  for (const LibraryObject& object : objects) {
    ++taken[lowerCase(withoutExtensions(object.key))];
    ++taken[lowerCase(object.key)];  // the folder of a.obj beside a.stl, and perhaps of a.obj.obj
    for (fs::path above = fs::path(object.key).parent_path(); !above.empty();
         above = above.parent_path()) {
      ++taken[lowerCase(above.generic_string())];
    }
  }
  for (LibraryObject& object : objects) {
    const std::string plain = withoutExtensions(object.key);
    object.folder = taken[lowerCase(plain)] == 1 ? plain : object.key;
  }
}

// Keeps objects with these keys.
void keepOnly(const std::set<std::string>& keys, const fs::path& library,
              std::vector<LibraryObject>& found) {
  std::erase_if(found, [&](const LibraryObject& object) { return !keys.contains(object.key); });
  std::string first;
  std::size_t missing = 0;
  auto next = found.begin();
  for (const std::string& key : keys) {
    if (next != found.end() && next->key == key) {
      ++next;
    } else if (missing++ == 0) {
      first = key;
    }
  }
  if (missing == 0) return;
  inputError(library, "lacks " + std::to_string(missing) + " of " + std::to_string(keys.size()) +
                          " meshes, the first is " + printable(first));
}

}  // namespace

std::vector<LibraryObject> findObjects(const fs::path& library, const LibraryOptions& options,
                                       std::vector<std::string>* skipped) {
  std::vector<LibraryObject> found;
  try {
    if (fs::is_directory(library)) {
      std::vector<std::string> sentences = addFolder(library, found);
      if (skipped) *skipped = std::move(sentences);
    } else if (!fs::is_regular_file(library)) {
      inputError(library, "is neither a mesh, nor a folder of meshes, nor a list of them");
    } else if (isMeshName(library) || isVolumeName(library)) {
      found.push_back(objectAt(library, library.filename().generic_string()));
    } else {
      addList(library, found);
    }
  } catch (const fs::filesystem_error& e) {
    inputError(library, std::string("cannot be read: ") + e.code().message());
  }
  const auto byKey = [](const auto& a, const auto& b) { return a.key < b.key; };
  std::sort(found.begin(), found.end(), byKey);
  const auto sameKey = [](const auto& a, const auto& b) { return a.key == b.key; };
  found.erase(std::unique(found.begin(), found.end(), sameKey), found.end());
  nameFolders(found);  // before the selection: a narrower one must not change names
  if (!options.keys.empty()) keepOnly(options.keys, library, found);
  addLicenses(found, options.licenses);
  if (!options.match.empty()) {
    std::erase_if(found, [&](const LibraryObject& object) {
      return ::fnmatch(options.match.c_str(), object.key.c_str(), 0) != 0;
    });
  }
  if (options.limit > 0 && found.size() > options.limit) found.resize(options.limit);
  if (found.empty()) {
    inputError(library, options.match.empty() ? "contains no mesh"
                                              : "contains no mesh that matches " + options.match);
  }
  return found;
}

std::vector<LibraryObject> shardOf(const std::vector<LibraryObject>& objects, Shard shard) {
  std::vector<std::size_t> order(objects.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return objects[a].bytes > objects[b].bytes;
  });
  std::vector<std::uintmax_t> load(static_cast<std::size_t>(shard.of), 0);
  std::vector<std::size_t> chosen;
  for (const std::size_t i : order) {
    const auto least = std::min_element(load.begin(), load.end());
    // Breaking takes a minimum time, however small the file.
    *least += objects[i].bytes + (std::uintmax_t{1} << 20);
    if (least - load.begin() == shard.number - 1) chosen.push_back(i);
  }
  std::sort(chosen.begin(), chosen.end());
  std::vector<LibraryObject> mine;
  for (const std::size_t i : chosen) mine.push_back(objects[i]);
  return mine;
}

}  // namespace sherd
