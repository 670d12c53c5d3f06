// Reads the licenses of meshes, and finds that of a mesh.
#include "dataset/recipe/licenses.h"

#include <fnmatch.h>

#include <algorithm>
#include <map>
#include <set>
#include <string_view>

#include "base/files/file_bytes.h"
#include "base/input_error.h"
#include "base/text/printable.h"

namespace sherd {
namespace {

bool isPattern(const MeshLicense& one) {
  return one.mesh.find_first_of("*?[") != std::string::npos;
}

bool matches(const MeshLicense& one, const LibraryObject& object) {
  return one.mesh == object.key ||
         (isPattern(one) && ::fnmatch(one.mesh.c_str(), object.key.c_str(), 0) == 0);
}

}  // namespace

void addLicenses(std::vector<LibraryObject>& objects, const std::vector<MeshLicense>& licenses) {
  std::map<std::string_view, std::string_view> byKey;
  std::vector<MeshLicense> patterns;
  for (const MeshLicense& one : licenses) {
    byKey.emplace(one.mesh, one.license);
    if (isPattern(one)) patterns.push_back(one);
  }
  for (LibraryObject& object : objects) {
    if (const auto found = byKey.find(object.key); found != byKey.end()) {
      object.license = found->second;
      continue;
    }
    const auto first = std::find_if(patterns.begin(), patterns.end(),
                                    [&](const MeshLicense& one) { return matches(one, object); });
    if (first != patterns.end()) object.license = first->license;
  }
}

std::vector<std::string> idleLicenses(const std::filesystem::path& library,
                                      const std::vector<MeshLicense>& licenses) {
  const std::vector<LibraryObject> objects = findObjects(library);
  std::set<std::string_view> keys;
  for (const LibraryObject& object : objects) keys.insert(object.key);
  std::vector<std::string> idle;
  for (const MeshLicense& one : licenses) {
    if (keys.contains(one.mesh)) continue;
    const bool isUsed =
        isPattern(one) && std::any_of(objects.begin(), objects.end(),
                                      [&](const auto& object) { return matches(one, object); });
    if (!isUsed) idle.push_back(one.mesh);
  }
  return idle;
}

std::vector<MeshLicense> readLicenses(const std::filesystem::path& file) {
  constexpr std::uintmax_t kLargest = std::uintmax_t{1} << 24;
  if (whatIsAt(file) != std::filesystem::file_type::regular) inputError(file, "is not a file");
  if (std::filesystem::file_size(file) > kLargest) inputError(file, "is larger than 16 MiB");
  const std::string text = readFileBytes(file);
  std::vector<MeshLicense> licenses;
  std::set<std::string> given;
  std::size_t number = 0;
  const std::string_view mark = "\xEF\xBB\xBF";  // of UTF-8, as Windows programs write it
  for (std::size_t at = text.starts_with(mark) ? mark.size() : 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    std::string_view line = std::string_view(text).substr(at, end - at);
    at = end + 1;
    ++number;
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (line.empty() || line.starts_with('#')) continue;
    const std::size_t tab = line.find('\t');
    if (tab == 0 || tab == std::string_view::npos || tab + 1 == line.size()) {
      inputError(file.string() + ":" + std::to_string(number),
                 "has no license; a line is a mesh or a pattern, a tab, and the license");
    }
    const std::string mesh(line.substr(0, tab));
    if (!given.insert(mesh).second) {
      inputError(file.string() + ":" + std::to_string(number),
                 printable(mesh) + " has a license in an earlier line");
    }
    licenses.push_back({mesh, std::string(line.substr(tab + 1))});
  }
  return licenses;
}

}  // namespace sherd
