// Makes all planned fractures of one assemblage.
#pragma once

#include <sherd/dataset.h>

#include "dataset/dataset_run.h"
#include "dataset/journal/journal.h"

namespace sherd {

/// Makes the fractures of an assemblage that its journal does not have yet, and records each in it.
///   throws  as runObject
void runAssemblage(const LibraryObject& assemblage, Journal& journal, const DatasetRun& run);

}  // namespace sherd
