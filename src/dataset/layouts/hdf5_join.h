// The HDF5 files of the layout hdf5.
//
// While objects are broken, each fracture has a file of its own below "parts", which is recorded in
// the object's journal like any other file.  At the end all are joined to one file, which is
// renamed to its name once it is complete and on the disk; then the parts are removed.  So a run
// that is killed loses what it was writing, and the joined file depends on the fractures only.
#pragma once

#include <sherd/dataset.h>

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "dataset/journal/journal.h"
#include "dataset/journal/plan.h"
#include "dataset/layouts/joined_file.h"

namespace sherd {

/// Returns the path of an object's group in the joined file.
[[nodiscard]] std::string hdf5Group(const LibraryObject& object);

/// Returns the joined files of a dataset that have the recorded size: one that was cut, or is
/// absent, is left out, and so are files without a record.
[[nodiscard]] std::vector<JoinedFile> joinedFiles(const std::filesystem::path& out);

/// Whether the fractures that a journal lists exist: as parts, or of a finished object in a joined
/// file.
[[nodiscard]] bool hasFractures(const std::filesystem::path& out, const LibraryObject& object,
                                const JournalText& journal, const std::vector<JoinedFile>& joined);

/// Joins the fractures of all finished objects of a shard, or of the whole dataset, to one file;
/// does nothing if that is done.  Removes parts, and for the whole dataset the files of shards.
///   throws  Error(output); Error(input) a part differs from what its journal records;
///           Error(cancelled)
void joinHdf5(const std::filesystem::path& out, const DatasetPlan& plan, Shard shard,
              const Progress* progress);

}  // namespace sherd
