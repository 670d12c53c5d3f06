// Makes all planned fractures of one object.
#pragma once

#include <sherd/dataset.h>

#include <atomic>
#include <map>
#include <mutex>
#include <set>
#include <string>

#include "dataset/dataset_run.h"
#include "dataset/journal/journal.h"

namespace sherd {

/// Makes the fractures of an object that its journal does not have yet, and records each in it.
///   throws  Error(input) the object cannot be broken, or options.objectTimeout has passed;
///           Error(cancelled); Error(output)
void runObject(const LibraryObject& object, Journal& journal, const DatasetRun& run);

}  // namespace sherd
