// Names of a fracture's files.
#pragma once

#include <sherd/folder.h>

#include <cstddef>
#include <string>
#include <vector>

#include "base/text/safe_name.h"
#include "formats/mesh/materials.h"

namespace sherd {

/// The files of a fracture, relative to its folder; empty where not written.
struct FractureFiles {
  std::vector<std::string> labels;  ///< [formats] or empty
  std::vector<std::string> vdb;     ///< [fragments that are not withheld] or empty
  std::string allVdb;               ///< all fragments in one file
  std::string solidVdb;
  std::vector<std::vector<std::string>> mesh;  ///< [fragments that are not withheld][formats] or
                                               ///< empty
  std::vector<std::vector<std::vector<std::string>>>
      coarse;                          ///< [as mesh][SurfaceOptions::triangles][formats] or empty
  std::vector<std::string> solidMesh;  ///< [formats] or empty
  std::string materials;               ///< the material library of .obj files
  std::vector<std::string> textures;   ///< [MaterialTable::textures] or empty
  std::vector<std::vector<std::string>> points;  ///< [fragments that are not withheld][formats] or
                                                 ///< empty
  std::vector<std::string> sdf;                  ///< [fragments that are not withheld] or empty
  std::vector<std::string> proxy;                ///< [fragments that are not withheld] or empty
  std::string solidSdf;
  std::string correspondences;
  std::string preview;
  std::string seeds;
  std::string boundaries;
  std::string cost;
  std::string scene;
  std::vector<std::string> usd;      ///< [formats] or empty
  std::vector<std::string> houdini;  ///< of the meshes, then of each number of triangles
  std::string graph;
  std::string constraints;
  std::string viewer;

  std::vector<std::string> all() const;
};

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
