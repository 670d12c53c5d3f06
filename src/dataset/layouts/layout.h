// The file names of a dataset.
#pragma once

#include <sherd/dataset.h>

#include <string>

#include "folder/manifest/manifest.h"
#include "formats/mesh/materials.h"

namespace sherd {

/// The files of one fracture, or of the intact object.
struct NamedFiles {
  std::string prefix;  ///< of every name, below the object's folder
  FractureFiles files;
  std::string manifest;  ///< empty if the layout has none
};

/// The inputs of file names.
struct NamedObject {
  const LibraryObject& object;
  std::string split;
  const SourceMesh& source;
  const MaterialTable& materials;
  const FractureOptions& options;
  const WriteOptions& write;
  int longestSide = 0;  ///< voxels
};

/// Whether files have the positions of the object, and are not in a frame of the layout's own.
[[nodiscard]] bool hasWorldPositions(DatasetLayout layout);

/// Returns the names of a fracture's files.
///   number     index of the fracture in the object's schedule, from 0
///   fragments  number of those that are not withheld
[[nodiscard]] NamedFiles fractureNames(DatasetLayout layout, const NamedObject& object,
                                       const PlannedFracture& fracture, std::size_t number,
                                       std::size_t fragments);

/// Returns the names of the intact object's files, which is written as a fracture of one fragment.
[[nodiscard]] NamedFiles wholeNames(DatasetLayout layout, const NamedObject& object);

/// Returns all files of fragment i, from 0.
[[nodiscard]] std::vector<std::string> filesOfFragment(const FractureFiles& files, std::size_t i);

}  // namespace sherd
