// Where a layout stores the files of an object.
#pragma once

#include "dataset/journal/plan.h"
#include "dataset/store/store.h"

namespace sherd {

/// Returns the place of an object's files.
///   options  checkedOptions
[[nodiscard]] StorePlace storeOf(const std::filesystem::path& out, const LibraryObject& object,
                                 const DatasetOptions& options, std::vector<FileRecord> kept = {},
                                 std::uint64_t archive = 0);

}  // namespace sherd
