// The index of a dataset: a row for each fragment, out of the journals.
#pragma once

#include <sherd/dataset.h>

#include <filesystem>
#include <string>

#include "dataset/figures.h"
#include "dataset/journal.h"
#include "dataset/plan.h"

namespace sherd {

/// Which part of the split an object is in: "train", "val" or "test".  By its key alone, so it
/// stays there when others are added.
[[nodiscard]] std::string splitOf(const std::string& key, const std::array<int, 3>& shares);

/// What is known once all journals have been read.
struct DatasetIndex {
  DatasetSummary summary;
  DatasetFigures figures;
};

/// Write index.csv, index.jsonl, failures.jsonl and the lists of the splits from the journals.
/// Objects that are neither done nor failed are left out, and the summary is not complete.
///   throws  Error(output)
DatasetIndex writeIndex(const std::filesystem::path& out, const DatasetPlan& plan,
                        const std::function<bool()>& cancelled = {});

}  // namespace sherd
