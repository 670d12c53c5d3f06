// How the files of a fracture are named.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "io/manifest.h"
#include "io/materials.h"

namespace sherd {

/// A text from a file as the name of a file or a thing, which JSON can hold: nothing but UTF-8, no
/// control characters, no slash, no dot to begin with, at most 200 bytes; `otherwise` where nothing
/// is left.
[[nodiscard]] std::string safeName(std::string name, const std::string& otherwise);

/// A name with '_' for each blank, for formats in which a blank ends it.
[[nodiscard]] std::string withoutBlanks(std::string name);

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
