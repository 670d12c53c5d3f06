// A glTF file as a whole: its JSON and its buffers.
#pragma once

#include <cstddef>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "formats/mesh/mesh_reader.h"

namespace sherd {

/// Arrays of objects that refer to each other by index; indices are checked on access. Values of an
/// unexpected JSON type throw nlohmann's exceptions, which readGltf() translates.
class GltfDocument {
 public:
  using Json = nlohmann::json;

  /// Reads a .gltf or .glb of version 2 and all its buffers.
  ///   throws  Error(input) cut short, malformed, a buffer that cannot be read, buffer views beyond
  ///           their buffers, accessors beyond their views, a required extension that is not
  ///           supported
  explicit GltfDocument(const MeshFile& file);

  const MeshFile& file() const { return *file_; }
  Error bad(const std::string& what) const { return inputError(*file_, what); }

  const Json& root() const { return json_; }
  /// Returns the array with that name, empty if absent.
  const Json& array(const char* name) const { return member(json_, name); }
  /// Returns an object of an array.
  ///   throws  Error(input) the index is out of range
  const Json& at(const char* array, std::size_t index) const;
  /// Returns a whole number below 2^32 of an object, `otherwise` if absent.
  std::size_t number(const Json& object, const char* name, std::size_t otherwise = 0) const;
  /// Returns an object or array of an object, empty if absent.
  static const Json& member(const Json& object, const char* name);

  std::string_view bufferView(std::size_t index) const;
  /// Bytes of the file and all its buffers.
  std::size_t bytes() const;
  /// Numbers per element of an accessor, and bytes per number.
  std::size_t components(const Json& accessor) const;
  std::size_t componentBytes(const Json& typed) const;

 private:
  std::string_view split();
  void checkShape() const;
  void checkVersion() const;
  void loadBuffers();
  std::string_view loadBuffer(const std::string& uri);
  void checkViews() const;
  void checkAccessors() const;

  const MeshFile* file_;
  std::optional<std::string_view> binaryChunk_;  // of a .glb
  Json json_;
  std::map<std::string, std::string> loaded_;  // by URI or path
  std::vector<std::string_view> buffers_;
};

/// Returns the bytes of a data URI in base64, up to the first character that is not base64.
[[nodiscard]] std::string dataUriBytes(std::string_view uri);

/// Decodes percent-encoded characters, as "%20".
[[nodiscard]] std::string percentDecoded(std::string_view text);

}  // namespace sherd
