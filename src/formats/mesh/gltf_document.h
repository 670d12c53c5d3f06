// A glTF file as a whole: its JSON, and the buffers that it refers to.
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

/// Arrays of objects that refer to each other by index, checked as they are asked for.  JSON of
/// another type than is asked for throws nlohmann's exceptions, which readGltf() translates.
class GltfDocument {
 public:
  using Json = nlohmann::json;

  /// Reads a .gltf or .glb of version 2 and all its buffers.
  ///   throws  Error(input) cut short, malformed, a buffer that cannot be read, buffer views beyond
  ///   their buffers, accessors beyond their views, an extension that is needed and not known
  explicit GltfDocument(const MeshFile& file);

  const MeshFile& file() const { return *file_; }
  Error bad(const std::string& what) const { return inputError(*file_, what); }

  const Json& root() const { return json_; }
  /// The array of that name, empty where there is none.
  const Json& array(const char* name) const { return member(json_, name); }
  /// The object of an array that a number points to.
  const Json& at(const char* array, std::size_t index) const;
  /// A whole number below 2^32 of an object.
  std::size_t number(const Json& object, const char* name, std::size_t otherwise = 0) const;
  /// An object or array in an object, empty where there is none.
  static const Json& member(const Json& object, const char* name);

  std::string_view bufferView(std::size_t index) const;
  /// Of the file and all its buffers.
  std::size_t bytes() const;
  /// How many numbers an element of an accessor has, and how many bytes each of them.
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
  std::map<std::string, std::string> loaded_;  // by where it came from
  std::vector<std::string_view> buffers_;
};

/// The bytes that the base64 text of a data URI stands for, up to the first character that is none
/// of base64's.
[[nodiscard]] std::string dataUriBytes(std::string_view uri);

/// "%20" and its like as the characters they stand for.
[[nodiscard]] std::string percentDecoded(std::string_view text);

}  // namespace sherd
