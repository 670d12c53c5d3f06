// How the files of a fracture are named.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "base/safe_name.h"
#include "folder/manifest.h"
#include "formats/mesh/materials.h"

namespace sherd {

/// A fragment's name: the stem, and its id with leading zeros to three digits or to as many as the
/// highest of `fragments` ids has.
[[nodiscard]] std::string pieceName(const std::string& stem, std::size_t id, std::size_t fragments);

/// Whether a fracture's folder may have a sub-folder of this name with files of its own.
[[nodiscard]] bool isSubfolder(const std::string& name);

/// The files that are to be written, in sub-folders of one level.
///   fragments  those that are not withheld
///   triangles  SurfaceOptions::triangles
[[nodiscard]] FractureFiles fileNames(const SourceMesh& source, std::size_t fragments,
                                      const std::vector<std::size_t>& triangles,
                                      const MaterialTable& table, const WriteOptions& write);

}  // namespace sherd
