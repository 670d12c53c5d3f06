// Where an object lies below a dataset's folder, and which names there are the dataset's own.
#pragma once

#include <sherd/dataset.h>

#include <string>
#include <vector>

namespace sherd {

// The dataset's own files at its top.  They and all other names that it keeps for itself are listed
// in object_folder.cpp.
inline constexpr const char* kPlanName = "dataset.json";
inline constexpr const char* kIndexCsv = "index.csv";
inline constexpr const char* kIndexJsonl = "index.jsonl";
inline constexpr const char* kFailuresName = "failures.jsonl";
inline constexpr const char* kReportName = "report.html";
inline constexpr const char* kJournalFolder = "journal";
inline constexpr const char* kBbSplitFolder = "data_split";
inline constexpr const char* kBbListFolder = "data_list";

/// What an object's folder is called below the dataset's.
[[nodiscard]] std::string objectFolder(DatasetLayout layout, const LibraryObject& object);

/// Rename the folders of objects that would be the dataset's own files, or hold them: each part of
/// a name that the layout keeps for itself, in whatever case, gets a '_' behind it, and so does
/// such a name that ends in '_' already.  So no two objects get one name, whatever else there is.
///   return  a sentence for each name that was changed
std::vector<std::string> renameReserved(DatasetLayout layout, std::vector<LibraryObject>& objects);

/// Whether an object's folder has another name than its file.
[[nodiscard]] bool isRenamed(const LibraryObject& object);

}  // namespace sherd
