// manifest.json: what a fracture is, and which files hold it.
#pragma once

#include <sherd/fracture.h>
#include <sherd/io.h>

#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace sherd {

/// The files of a fracture, relative to its folder; empty where not written.
struct FractureFiles {
  std::vector<std::string> labels;  ///< [formats] or empty
  std::vector<std::string> vdb;     ///< [fragments that are not withheld] or empty
  std::string allVdb;               ///< of all of these
  std::string solidVdb;
  std::vector<std::vector<std::string>> mesh;  ///< [fragments that are not withheld][formats] or
                                               ///< empty
  std::vector<std::vector<std::vector<std::string>>>
      coarse;                          ///< [of these][SurfaceOptions::triangles][formats] or empty
  std::vector<std::string> solidMesh;  ///< [formats] or empty
  std::string materials;               ///< the library of .obj files
  std::vector<std::string> textures;   ///< [MaterialTable::textures] or empty
  std::vector<std::vector<std::string>> points;  ///< [fragments that are not withheld][formats] or
                                                 ///< empty
  std::vector<std::string> sdf;                  ///< [fragments that are not withheld] or empty
  std::vector<std::string> proxy;                ///< [fragments that are not withheld] or empty
  std::string solidSdf;
  std::string correspondences;
  std::string preview;
  std::string seeds;
  std::string rims;
  std::string cost;
  std::string scene;
  std::string graph;
  std::string constraints;

  std::vector<std::string> all() const;
};

/// What a manifest tells of a fragment's mesh.
struct MeshFacts {
  Box box;
  std::map<int, double> rimLengths;  ///< by the fragment that is faced, world units
};

/// [fragments]
[[nodiscard]] std::vector<MeshFacts> meshFacts(std::span<const Fragment> fragments);

/// The manifest as text.  It holds no times and no machine names, and its numbers read back as they
/// were: equal fractures give equal bytes.  The fragments' meshes and level sets are not used.
///   facts  [fragments] meshFacts of all
[[nodiscard]] std::string manifestText(const SourceMesh& source, const FractureOptions& options,
                                       const FractureResult& result,
                                       std::span<const MeshFacts> facts, const FractureFiles& files,
                                       const WriteOptions& write);

}  // namespace sherd
