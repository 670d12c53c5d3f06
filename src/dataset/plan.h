// dataset.json: what a run keeps of itself below its folder, so that others can go on.
#pragma once

#include <sherd/dataset.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace sherd {

struct DatasetPlan {
  std::string text;                    ///< DatasetOptions::plan
  std::vector<LibraryObject> objects;  ///< of all shards
  DatasetLayout layout = DatasetLayout::sherd;
  std::array<int, 3> split{};
  std::uint64_t seed = 0;
};

///   throws  Error(output)
void writePlan(const std::filesystem::path& out, const DatasetPlan& plan);

///   throws  Error(input) with the file's name: it is no dataset, or as parsedPlan
[[nodiscard]] DatasetPlan readPlan(const std::filesystem::path& out);

/// The text of such a file.  Objects have no `file`.
///   throws  Error(input) without the file's name: it is no JSON, of another schema, a field is
///           missing, of another kind or out of range, a folder leaves the dataset's
[[nodiscard]] DatasetPlan parsedPlan(std::string_view text);

/// Whether a folder is a dataset.
[[nodiscard]] bool hasPlan(const std::filesystem::path& out);

}  // namespace sherd
