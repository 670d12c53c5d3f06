// Reads the licenses of meshes.
#include <sherd/dataset.h>

#include <algorithm>
#include <string_view>

#include "base/files/file_bytes.h"
#include "base/input_error.h"

namespace sherd {

std::map<std::string, std::string> readLicenses(const std::filesystem::path& file) {
  constexpr std::uintmax_t kLargest = std::uintmax_t{1} << 24;
  if (whatIsAt(file) != std::filesystem::file_type::regular) inputError(file, "is not a file");
  if (std::filesystem::file_size(file) > kLargest) inputError(file, "is larger than 16 MiB");
  const std::string text = readFileBytes(file);
  std::map<std::string, std::string> licenses;
  std::size_t number = 0;
  for (std::size_t at = 0; at < text.size();) {
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
    licenses.emplace(line.substr(0, tab), line.substr(tab + 1));
  }
  return licenses;
}

}  // namespace sherd
