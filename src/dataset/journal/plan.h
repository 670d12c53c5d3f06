// dataset.json: the plan of a run, which other runs read to resume it.
#pragma once

#include <sherd/dataset.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace sherd {

/// Bytes of a dataset.json or recipe.json that is read.
inline constexpr std::uintmax_t kLargestPlan = std::uintmax_t{1} << 30;

struct DatasetPlan {
  std::string text;                    ///< datasetIdentity
  std::vector<LibraryObject> objects;  ///< those of all shards
  DatasetLayout layout = DatasetLayout::sherd;
  std::array<int, 3> split{};
  std::uint64_t seed = 0;
};

/// Returns the text of dataset.json.
[[nodiscard]] std::string planText(const DatasetPlan& plan);

/// Writes OUT/dataset.json.
///   throws  Error(output)
void writePlan(const std::filesystem::path& out, const DatasetPlan& plan);

/// Reads OUT/dataset.json.
///   throws  Error(input) with the file's name: not a dataset, or an error of parsedPlan
[[nodiscard]] DatasetPlan readPlan(const std::filesystem::path& out);

/// Parses the text of such a file.  Objects have no `file`.
///   throws  Error(input) without the file's name: not JSON, of another schema; a field is missing,
///           of another kind or out of range; a folder lies outside the dataset's
[[nodiscard]] DatasetPlan parsedPlan(std::string_view text);

/// Whether a folder is a dataset.
[[nodiscard]] bool hasPlan(const std::filesystem::path& out);

}  // namespace sherd
