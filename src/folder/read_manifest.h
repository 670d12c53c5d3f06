// manifest.json read back: anybody may have written it.
#pragma once

#include <sherd/grid_fwd.h>

#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

namespace sherd {

inline constexpr const char* kManifestName = "manifest.json";
inline constexpr const char* kManifestSchema = "sherd/1";
inline constexpr const char* kAutomatic = "auto";  ///< options.resolution where it was chosen
inline constexpr const char* kPartialName = ".sherd-partial";  ///< the folder of an unfinished one

/// A fragment as a manifest has it.
struct ManifestFragment {
  int id = 0;  ///< its place in the list, from 1
  std::uint64_t voxels = 0;
  double share = 0.0;   ///< of all voxels, 0..1
  double volume = 0.0;  ///< finite, as all numbers here
  double area = 0.0;
  double fractureArea = 0.0;
  std::size_t contacts = 0;
  std::vector<std::string> meshes;  ///< [formats], or empty where none was written
  std::string vdb;                  ///< empty where none was written
};

/// What of a manifest is read back.  Every file that a field names is one of `files`.
struct Manifest {
  std::string source;  ///< the mesh's file name
  std::uint64_t seed = 0;
  int resolution = 0;      ///< above 0
  bool automatic = false;  ///< the resolution was chosen for the mesh
  double voxelSize = 0.0;  ///< above 0
  openvdb::Coord dims;     ///< each above 0
  openvdb::Coord indexMin;
  std::uint64_t solidVoxels = 0;
  std::uint64_t parts = 0;
  std::vector<std::string> files;  ///< below the manifest's folder, see listedFiles
  std::string allVdb;              ///< all fragments in one; empty where it was not written
  std::vector<ManifestFragment> fragments;  ///< [1..kMaxFragments], without the withheld
};

/// A manifest's JSON as values.
///   throws  Error(input) without the file's name: another schema, a field that is missing, of
///           another kind or out of range, ids that are not 1, 2, 3, ..., a file outside the folder
[[nodiscard]] Manifest manifestOf(const nlohmann::json& json);

/// A file as a manifest, which it has to be.  Where a killed run left the fracture half replaced,
/// the earlier one is put back first.
///   throws  Error(input) it is absent, larger than 1 GiB, no JSON, or as above; what
///           requireSettled throws
[[nodiscard]] Manifest readManifest(const std::filesystem::path& file);

/// Where a file of a manifest is.
///   throws  Error(input) a symbolic link on the way leads out of the manifest's folder
[[nodiscard]] std::filesystem::path listedFile(const std::filesystem::path& manifest,
                                               const std::string& name);

/// The files that a manifest lists, if each is a path below its folder: relative, without "..",
/// without bytes of 0, no part longer than 255 bytes, neither the manifest itself nor in the folder
/// that an unfinished fracture is in.
[[nodiscard]] std::optional<std::vector<std::string>> listedFiles(const nlohmann::json& manifest);

/// A file's JSON, if it is a manifest by its schema, whatever else it holds.
[[nodiscard]] std::optional<nlohmann::json> manifestJson(const std::filesystem::path& file);

}  // namespace sherd
