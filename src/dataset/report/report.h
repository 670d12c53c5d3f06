// OUT/report.html: a summary of a dataset.
#pragma once

#include <filesystem>

#include "dataset/report/statistics.h"

namespace sherd {

/// Writes a self-contained page: images of objects and fractures (the paper's Figure 16),
/// histograms (Figure 17), the rows of Table 3, stage times and resources (Figures 12 and 13),
/// storage by format, and failures.
///   throws  Error(output)
void writeReport(const std::filesystem::path& out, const DatasetStatistics& statistics);

}  // namespace sherd
