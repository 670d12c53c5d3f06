// How the files of a dataset are named.
#pragma once

#include <sherd/dataset.h>

#include <string>

#include "folder/manifest.h"
#include "formats/mesh/materials.h"

namespace sherd {

/// The files of one fracture, or of the unbroken object.
struct NamedFiles {
  std::string prefix;  ///< before each, below the object's folder
  FractureFiles files;
  std::string manifest;  ///< empty where the layout has none
};

/// What names are made from.
struct NamedObject {
  const SourceMesh& source;
  const MaterialTable& materials;
  const FractureOptions& options;
  const WriteOptions& write;
  int longestSide = 0;  ///< voxels
};

///   number     of the fracture in the object's schedule, from 0
///   fragments  that are not withheld
[[nodiscard]] NamedFiles fractureNames(DatasetLayout layout, const NamedObject& object,
                                       const PlannedFracture& fracture, std::size_t number,
                                       std::size_t fragments);

/// Of the unbroken object, which is written as a fracture of one fragment.
[[nodiscard]] NamedFiles wholeNames(DatasetLayout layout, const NamedObject& object);

/// All files of a fragment.
[[nodiscard]] std::vector<std::string> filesOfFragment(const FractureFiles& files, std::size_t i);

}  // namespace sherd
