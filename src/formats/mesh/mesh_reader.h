// The interface of mesh readers: their input and their result.
#pragma once

#include <sherd/error.h>
#include <sherd/mesh.h>
#include <sherd/progress.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/cancel_flag.h"
#include "base/memory_budget.h"

namespace sherd {

enum class MeshFormat { obj, ply, stl, off, gltf, glb, binm, fbx, dae, threeMf };

/// A mesh file in memory, unpacked.
struct MeshFile {
  std::filesystem::path path;
  std::string name;  ///< file name without folder, for messages
  MeshFormat format;
  std::string bytes;
  MemoryBudget* memory = nullptr;      ///< limit on memory for reading; null: no limit
  const Progress* progress = nullptr;  ///< may be null
  std::string attribute{};             ///< of vertices, to be read into RawMesh::values
};

/// Charges memory that is about to be allocated.
///   throws  Error(input) it exceeds the limit
inline void charge(const MeshFile& file, std::uint64_t count, std::uint64_t bytesEach = 1) {
  if (file.memory != nullptr) file.memory->charge(count, bytesEach);
}

/// To be called regularly in long loops.
///   throws  Error(cancelled) the caller cancelled
inline void checkpoint(const MeshFile& file) { throwIfCancelled(file.progress); }

/// A reader's result: node transforms applied, polygons triangulated, nothing merged or dropped.
/// readMesh() checks these invariants by contradictionIn().
struct RawMesh {
  std::vector<glm::dvec3> vertices;             ///< as in the file, finite or not
  std::vector<glm::uvec3> triangles;            ///< indices below vertices.size()
  SurfaceAttributes attributes;                 ///< arrays of [triangles], or empty; normals as in
                                                ///< the file, which completeNormals() makes unit
  std::vector<std::uint16_t> neighbor;          ///< [triangles] see TriangleMesh, or empty
  Appearance appearance;                        ///< what `attributes` refers to
  std::vector<std::string> objects;             ///< names of the file's parts
  std::vector<std::uint32_t> objectOfTriangle;  ///< [triangles] below objects.size(), or empty
  std::vector<PolygonPart> polygons;            ///< [triangles] see SourceMesh, or empty
  std::vector<std::string> warnings;            ///< see SourceMesh
  std::vector<float> values{};  ///< [vertices] of MeshFile::attribute; empty if the file has none
  std::vector<std::string> valueNames{};  ///< of the attributes that could be read, if one is given
  std::optional<double> metersPerUnit{};  ///< above 0; none: the file does not say
  std::optional<char> up{};               ///< 'x', 'y' or 'z'; none: the file does not say
};

/// An error about a file's content: "bowl.stl: what".
inline Error inputError(const MeshFile& file, const std::string& what) {
  return Error(ErrorCode::input, file.name + ": " + what);
}

/// An error about a line of a text file: "bowl.obj:412: what".
inline Error inputError(const MeshFile& file, std::size_t line, const std::string& what) {
  return Error(ErrorCode::input, file.name + ":" + std::to_string(line) + ": " + what);
}

}  // namespace sherd
