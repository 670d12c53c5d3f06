// The folders of objects below a dataset's folder, and the names that are reserved there.
#pragma once

#include <sherd/dataset.h>

#include <string>
#include <vector>

namespace sherd {

// The dataset's own top-level files.  object_folder.cpp lists all reserved names.
inline constexpr const char* kPlanName = "dataset.json";
inline constexpr const char* kIndexCsv = "index.csv";
inline constexpr const char* kIndexJsonl = "index.jsonl";
inline constexpr const char* kFailuresName = "failures.jsonl";
inline constexpr const char* kReportName = "report.html";
inline constexpr const char* kRecipeName = "recipe.json";
inline constexpr const char* kJournalFolder = "journal";
inline constexpr const char* kBbSplitFolder = "data_split";
inline constexpr const char* kBbListFolder = "data_list";
inline constexpr const char* kHdf5PartFolder = "parts";
inline constexpr const char* kPfppPointFolder = "pc_data";
inline constexpr const char* kPfppMatchFolder = "matching_data";

/// Returns the path of an object's folder below the dataset's.  With the layout pfpp it stays
/// absent: the files of all objects lie together (pfpp.h).
[[nodiscard]] std::string objectFolder(DatasetLayout layout, const LibraryObject& object);

/// Renames folders of objects that collide with the dataset's own files: appends '_' to each part
/// of a path that the layout reserves, in any case.  A reserved name with '_' behind it gets one
/// more, so no two objects get the same name.
///   return  a sentence for each changed name
std::vector<std::string> renameReserved(DatasetLayout layout, std::vector<LibraryObject>& objects);

/// Whether the name of an object's folder differs from its file's.
[[nodiscard]] bool isRenamed(const LibraryObject& object);

}  // namespace sherd
