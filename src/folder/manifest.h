// manifest.json: the options, statistics and files of a fracture.
#pragma once

#include <sherd/folder.h>
#include <sherd/fracture.h>

#include <filesystem>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "folder/input_bodies.h"

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

/// Metrics of a fragment's mesh in the manifest.
struct MeshFacts {
  Box box;
  std::map<int, double> boundaryLengths;          ///< of contacts by neighbor id, world units
  std::optional<std::size_t> roundedCrossings{};  ///< of an exact mesh
  std::vector<std::uint32_t> bodies{};            ///< InputBodies::of it
};

/// Returns [fragments] the metrics of each mesh.
///   bodies  of the input
[[nodiscard]] std::vector<MeshFacts> meshFacts(std::span<const Fragment> fragments,
                                               const InputBodies& bodies = {});

/// The same of surfaces.
[[nodiscard]] std::vector<MeshFacts> meshFacts(const FragmentSurfaces& surfaces);

/// The same of a fracture: of its surfaces, or where these are null, of its meshes.
[[nodiscard]] std::vector<MeshFacts> meshFacts(const FractureResult& result,
                                               const InputBodies& bodies);

/// Returns a sentence about triangles that cross each other in files of single precision; empty if
/// there are none, or no such files.
[[nodiscard]] std::string crossingsWarning(std::span<const MeshFacts> facts,
                                           const WriteOptions& write);

/// Returns how many voxels the longest side has.
[[nodiscard]] int resolutionUsed(const SourceMesh& source, const FractureOptions& options,
                                 const Solid& solid);

/// Returns the beginning of a manifest: what was broken, the options, and the breaks before.
[[nodiscard]] nlohmann::ordered_json breakJson(const SourceMesh& source,
                                               const FractureOptions& options,
                                               const FractureResult& result,
                                               const WriteOptions& write);

/// Returns the manifest's text.  It has no times or machine names, and its numbers round-trip, so
/// equal fractures give equal bytes.  The fragments' meshes and level sets are not used.
///   facts   [fragments] as returned by meshFacts
///   bodies  of the input
[[nodiscard]] std::string manifestText(const SourceMesh& source, const FractureOptions& options,
                                       const FractureResult& result,
                                       std::span<const MeshFacts> facts, const InputBodies& bodies,
                                       const FractureFiles& files, const WriteOptions& write);

}  // namespace sherd
