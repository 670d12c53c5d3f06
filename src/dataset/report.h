// OUT/report.html: what a dataset holds, at a glance.
#pragma once

#include <filesystem>

#include "dataset/figures.h"

namespace sherd {

/// Write a page that needs nothing else: pictures of objects and fractures (the paper's Figure 16),
/// histograms (Figure 17), the rows of Table 3, times of stages and resources (Figures 12 and 13),
/// storage by format, and failures.
///   throws  Error(output)
void writeReport(const std::filesystem::path& out, const DatasetFigures& figures);

}  // namespace sherd
