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

#include "folder/manifest/file_names.h"
#include "folder/manifest/input_bodies.h"

namespace sherd {

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
///   assemblage  of several objects: one JSON object for each; else null
[[nodiscard]] std::string manifestText(const SourceMesh& source, const FractureOptions& options,
                                       const FractureResult& result,
                                       std::span<const MeshFacts> facts, const InputBodies& bodies,
                                       const FractureFiles& files, const WriteOptions& write,
                                       const nlohmann::ordered_json* assemblage = nullptr);

}  // namespace sherd
