// Names of a fracture's files.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "base/text/safe_name.h"
#include "folder/manifest.h"
#include "formats/mesh/materials.h"

namespace sherd {

/// Whether a fracture can have files in a subfolder of this name.
[[nodiscard]] bool isSubfolder(const std::string& name);

/// Returns the names of the files to write, in subfolders of one level.
///   fragments  number of fragments that are not withheld
///   triangles  SurfaceOptions::triangles
[[nodiscard]] FractureFiles fileNames(const SourceMesh& source, std::size_t fragments,
                                      const std::vector<std::size_t>& triangles,
                                      const MaterialTable& table, const WriteOptions& write);

/// Returns the names of files for Houdini: of the meshes, then of each number of triangles.
[[nodiscard]] std::vector<std::string> houdiniNames(const std::string& prefix,
                                                    const std::vector<std::size_t>& triangles);

}  // namespace sherd
