// The content of a model part of a 3MF file.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/gtc/type_precision.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "formats/mesh/mesh_reader.h"

namespace sherd {

constexpr std::size_t kLongestName3mf = 1024;  ///< bytes of an object's or a material's name

/// Returns the name of a part as it is compared: names have no case, and begin with a slash or not.
[[nodiscard]] std::string partName3mf(std::string_view name);

/// Returns that of an attribute, whose entities are not decoded.
[[nodiscard]] std::string decodedPartName3mf(std::string_view attribute);

/// p' = linear * p + offset.
struct Transform3mf {
  glm::dmat3 linear{1.0};
  glm::dvec3 offset{0.0};

  [[nodiscard]] Transform3mf operator*(const Transform3mf& inner) const {
    return {linear * inner.linear, linear * inner.offset + offset};
  }
};

/// Another object, where a component or an item of the build shows it.
struct Reference3mf {
  static constexpr std::uint32_t kSameModel = 0xffffffff;
  std::uint32_t object = 0;
  std::uint32_t path = kSameModel;  ///< of its model, in Model3mf::paths
  Transform3mf transform{};
};

/// A property of the corners of a triangle: a group, and three indices into it.
struct Property3mf {
  static constexpr std::uint32_t kNone = 0xffffffff;  ///< of an object or a triangle
  std::uint32_t group = kNone;
  std::array<std::uint32_t, 3> index{};
};

struct Object3mf {
  std::string name{};
  std::vector<glm::dvec3> vertices{};
  std::vector<glm::uvec3> triangles{};
  std::vector<Property3mf> properties{};  ///< [triangles], or empty: no triangle has one
  std::vector<Reference3mf> components{};
};

/// A group of properties.
struct Group3mf {
  std::string kind{};                 ///< name of its element
  std::vector<glm::u8vec3> colors{};  ///< of a colorgroup, or of materials in basematerials
  std::vector<std::string> names{};   ///< of materials
};

struct Model3mf {
  std::string unit{};
  std::map<std::uint32_t, Object3mf> objects{};
  std::map<std::uint32_t, Group3mf> groups{};
  std::vector<Reference3mf> items{};  ///< of the build
  std::vector<std::string> paths{};   ///< of other models, each once, by partName3mf()
  bool hasBeams = false;
  bool hasCutNames = false;  ///< some were longer than kLongestName3mf
};

/// Parses a model.
///   file    for messages and cancellation; charged with what is read
///   name    of the part, for messages
///   throws  Error(input); Error(cancelled)
[[nodiscard]] Model3mf parsed3mf(const MeshFile& file, const std::string& name,
                                 std::string_view xml);

}  // namespace sherd
