// The index of a dataset: one row per fragment, from the journals.
#pragma once

#include <sherd/dataset.h>

#include <filesystem>
#include <string>

#include "dataset/journal/journal.h"
#include "dataset/journal/plan.h"
#include "dataset/report/statistics.h"

namespace sherd {

/// The content of all journals.
struct DatasetIndex {
  DatasetSummary summary;
  DatasetStatistics statistics;
};

/// Writes index.csv, index.jsonl, failures.jsonl, recipe.json (not of assemblages) and the lists of
/// the splits from the journals.  Omits objects that are neither done nor failed; the summary is
/// then not complete.
///   throws  Error(output)
DatasetIndex writeIndex(const std::filesystem::path& out, const DatasetPlan& plan,
                        const Progress* progress = nullptr);

}  // namespace sherd
