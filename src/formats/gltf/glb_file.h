// A binary glTF 2.0 file in the making.
//
//     magic, version 2, length | JSON chunk, padded with blanks | BIN chunk, padded with zeros
//
// Every buffer view begins at a multiple of four bytes, and holds one attribute, one list of
// indices, or one image.
#pragma once

#include <sherd/files.h>

#include <cstddef>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

namespace sherd {

// glTF's constants for component types and for targets of buffer views.
inline constexpr int kGltfUnsignedShort = 5123, kGltfUnsignedInt = 5125, kGltfFloat = 5126;
inline constexpr int kGltfVertices = 34962, kGltfIndices = 34963, kGltfNoTarget = 0;

struct GlbFile {
  using Json = nlohmann::ordered_json;

  /// Begins a buffer view of all bytes that are stored until end().
  void begin() { from_ = bytes.size(); }
  /// Ends it.
  ///   stride  bytes between elements; 0: they are tightly packed
  ///   return  its number
  std::size_t end(int target, int stride = 0);
  /// Adds an accessor of a whole view.
  std::size_t accessor(std::size_t view, int componentType, std::size_t count, const char* type);

  /// Writes the file with one scene: where the coordinates are not glTF's, below a node that
  /// converts them.
  ///   roots   nodes without a parent
  ///   name    of that node
  ///   throws  Error(output), also if it would have 2^32 bytes or more
  void write(const OutputFile& file, std::vector<std::size_t> roots,
             const CoordinateSystem& coordinates, const std::string& name);

  std::string bytes;  ///< of the BIN chunk
  Json nodes = Json::array(), meshes = Json::array(), materials = Json::array(),
       textures = Json::array(), samplers = Json::array(), images = Json::array(),
       accessors = Json::array(), views = Json::array();
  Json extensions = Json::object();      ///< of the whole file
  std::set<std::string> extensionsUsed;  ///< anywhere

 private:
  Json document(const std::vector<std::size_t>& roots);

  Json asset_ = Json::object();

  std::size_t from_ = 0;
};

}  // namespace sherd
