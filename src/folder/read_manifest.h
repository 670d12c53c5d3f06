// Reads manifest.json; the file is untrusted.
#pragma once

#include <sherd/solid.h>

#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

namespace sherd {

inline constexpr const char* kManifestName = "manifest.json";
inline constexpr const char* kManifestSchema = "sherd/2";
inline constexpr const char* kFormerManifestSchema = "sherd/1";  ///< read too, never written
inline constexpr const char* kAutomatic = "auto";              ///< options.resolution if automatic
inline constexpr const char* kPartialName = ".sherd-partial";  ///< folder of an unfinished fracture

/// A fragment in a manifest.
struct ManifestFragment {
  int id = 0;  ///< position in the list, from 1
  std::uint64_t voxels = 0;
  double share = 0.0;   ///< of all voxels, 0..1
  double volume = 0.0;  ///< finite, like all numbers here
  double area = 0.0;
  double fractureArea = 0.0;
  std::size_t contacts = 0;
  std::vector<std::string> meshes;  ///< [formats]; empty if none was written
  std::string vdb;                  ///< empty if none was written
};

/// The fields of a manifest that are read.  Every file named by a field is in `files`.
struct Manifest {
  std::string source;  ///< the mesh's file name
  std::uint64_t seed = 0;
  int resolution = 0;      ///< above 0
  bool automatic = false;  ///< the resolution was chosen automatically
  double voxelSize = 0.0;  ///< above 0
  openvdb::Coord dims;     ///< each above 0
  openvdb::Coord indexMin;
  std::uint64_t solidVoxels = 0;
  std::uint64_t components = 0;
  std::vector<std::string> files;           ///< below the manifest's folder, see listedFiles
  std::string allVdb;                       ///< all fragments in one; empty if not written
  std::vector<ManifestFragment> fragments;  ///< [1..kMaxFragments], without withheld ones
};

/// Converts a manifest's JSON.
///   throws  Error(input) without the file's name: another schema, a field that is missing, of
///           another type or out of range, ids that are not 1, 2, 3, ..., a file outside the folder
[[nodiscard]] Manifest manifestOf(const nlohmann::json& json);

/// Reads a manifest, after restoring a fracture that a killed run left half replaced.
///   throws  Error(input) absent, larger than 1 GiB, not JSON, or as manifestOf; what
///           requireSettled throws
[[nodiscard]] Manifest readManifest(const std::filesystem::path& file);

/// Returns the path of a file listed in a manifest.
///   throws  Error(input) a symbolic link on the way leads out of the manifest's folder
[[nodiscard]] std::filesystem::path listedFile(const std::filesystem::path& manifest,
                                               const std::string& name);

/// Returns the files that a manifest lists; nothing unless each satisfies isBelowFolder and is
/// neither the manifest nor in kPartialName.
[[nodiscard]] std::optional<std::vector<std::string>> listedFiles(const nlohmann::json& manifest);

/// Returns a file's JSON if it has a manifest's schema; other fields are not checked.
[[nodiscard]] std::optional<nlohmann::json> manifestJson(const std::filesystem::path& file);

}  // namespace sherd
