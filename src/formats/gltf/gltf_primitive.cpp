// One primitive of a glTF file's mesh.
#include "formats/gltf/gltf_primitive.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string>
#include <utility>

#include "base/text/lower_case.h"
#include "formats/gltf/gltf_accessor.h"
#include "formats/gltf/gltf_attributes.h"
#include "formats/gltf/gltf_draco.h"

namespace sherd {
namespace {

using Json = GltfDocument::Json;

constexpr std::size_t kTriangles = 4, kStrip = 5, kFan = 6;

// The arrays of a primitive, decoded by Draco or read from accessors.
class Attributes {
 public:
  //   names  all attributes that are read
  Attributes(const GltfDocument& document, const Json& primitive,
             const std::set<std::string>& names)
      : document_(document),
        attributes_(GltfDocument::member(primitive, "attributes")),
        draco_(decodeDraco(document, primitive, names)) {
    if (!attributes_.is_object() || !attributes_.contains("POSITION"))
      throw document_.bad("a mesh has no 'POSITION'");
  }

  // To be called once per name: arrays that Draco decoded are moved, so that they are held once.
  std::optional<GltfArray> take(const std::string& name) {
    if (draco_) {
      const auto found = draco_->attributes.find(name);
      if (found != draco_->attributes.end()) return std::move(found->second);
    }
    if (!attributes_.contains(name)) return std::nullopt;
    return readGltfArray(document_, document_.number(attributes_, name.c_str()));
  }

  const std::optional<GltfDraco>& draco() const { return draco_; }

 private:
  const GltfDocument& document_;
  const Json& attributes_;
  std::optional<GltfDraco> draco_;
};

Error usesVertex(const GltfDocument& document, std::uint32_t vertex, std::size_t vertices) {
  return document.bad("face uses vertex " + std::to_string(vertex) + ", its mesh has " +
                      std::to_string(vertices));
}

// Returns the vertex indices in the primitive's order.
std::vector<std::uint32_t> readIndices(const GltfDocument& document, const Json& primitive,
                                       std::size_t vertices) {
  std::vector<std::uint32_t> out;
  if (!primitive.contains("indices")) {
    charge(document.file(), vertices, sizeof(std::uint32_t));
    out.reserve(vertices);
    for (std::size_t i = 0; i < vertices; ++i) out.push_back(static_cast<std::uint32_t>(i));
    return out;
  }
  const std::size_t index = document.number(primitive, "indices");
  const std::size_t type = document.number(document.at("accessors", index), "componentType");
  const GltfArray array = readGltfArray(document, index);
  if (array.components != 1 || (type != 5121 && type != 5123 && type != 5125))
    throw document.bad("a mesh's 'indices' are not unsigned whole numbers");
  charge(document.file(), array.count, sizeof(std::uint32_t));
  out.reserve(array.count);
  for (const double value : array.values) {
    if (value >= static_cast<double>(vertices))
      throw usesVertex(document, static_cast<std::uint32_t>(value), vertices);
    out.push_back(static_cast<std::uint32_t>(value));
  }
  return out;
}

std::vector<glm::uvec3> trianglesOf(const GltfDocument& document,
                                    const std::vector<std::uint32_t>& at, std::size_t mode) {
  std::vector<glm::uvec3> out;
  const std::size_t step = mode == kTriangles ? 3 : 1;
  const std::size_t count = at.size() < 3 ? 0 : (at.size() - 3) / step + 1;
  charge(document.file(), count, sizeof(glm::uvec3));
  out.reserve(count);
  for (std::size_t i = 0; i + 2 < at.size(); i += step) {
    if (mode == kFan) {
      out.emplace_back(at[i + 1], at[i + 2], at[0]);
    } else {
      const bool flipped = mode == kStrip && i % 2 == 1;
      out.emplace_back(at[i], at[i + (flipped ? 2 : 1)], at[i + (flipped ? 1 : 2)]);
    }
  }
  return out;
}

// Returns the triangles that Draco decoded. Positions may be stored outside of it, in any number.
std::vector<glm::uvec3> unpackedTriangles(const GltfDocument& document, const GltfDraco& draco,
                                          std::size_t vertices) {
  for (const glm::uvec3& t : draco.triangles) {
    const std::uint32_t largest = std::max({t.x, t.y, t.z});
    if (largest >= vertices) throw usesVertex(document, largest, vertices);
  }
  return draco.triangles;
}

void requireLength(const GltfDocument& document, const GltfArray& array, std::size_t length,
                   std::size_t components, const std::string& name) {
  if (array.count == length && array.components >= components) return;
  throw document.bad("a mesh's '" + name + "' is not of " + std::to_string(components) +
                     " numbers for each of its " + std::to_string(length) + " vertices");
}

std::vector<glm::dvec3> positionsOf(const GltfDocument& document, const GltfArray& array) {
  if (array.components != 3) throw document.bad("a mesh's 'POSITION' is not of three numbers");
  charge(document.file(), array.count, sizeof(glm::dvec3));
  std::vector<glm::dvec3> positions;
  positions.reserve(array.count);
  for (std::size_t i = 0; i < array.count; ++i) {
    positions.emplace_back(array.at(i, 0), array.at(i, 1), array.at(i, 2));
  }
  return positions;
}

constexpr std::array<const char*, 4> kChannels{"red", "green", "blue", "alpha"};

// An attribute, and which of its numbers.
struct WantedValues {
  std::string attribute;  // empty: the primitive has none
  std::size_t component = 0;
};

// Returns where the values of MeshFile::attribute are.  Upper case and a first underscore, which
// glTF requires, need not be given.
WantedValues valuesWanted(const GltfDocument& document, const Json& primitive) {
  const std::string wanted = lowerCase(document.file().attribute);
  if (wanted.empty()) return {};
  for (const auto& [name, accessor] : GltfDocument::member(primitive, "attributes").items()) {
    const std::string own = lowerCase(name);
    if (own.starts_with('_') && (own == wanted || own.substr(1) == wanted)) return {name};
    const auto* const channel = std::find(kChannels.begin(), kChannels.end(), wanted);
    if (name == "COLOR_0" && channel != kChannels.end()) {
      return {name, static_cast<std::size_t>(channel - kChannels.begin())};
    }
  }
  return {};
}

std::vector<float> valuesOf(const GltfDocument& document, const std::optional<GltfArray>& array,
                            std::size_t vertices, std::size_t component, const std::string& name) {
  std::vector<float> values;
  if (!array) return values;
  requireLength(document, *array, vertices, component + 1, name);
  if (name != "COLOR_0" && array->components > 1) {
    throw document.bad("a mesh's '" + name + "' is not of one number for each of its vertices");
  }
  charge(document.file(), array->count, sizeof(float));
  values.reserve(array->count);
  for (std::size_t i = 0; i < array->count; ++i) {
    values.push_back(static_cast<float>(array->at(i, component)));
  }
  return values;
}

}  // namespace

std::uint64_t GltfPrimitive::bytes() const {
  return positions.size() * sizeof(glm::dvec3) + triangles.size() * sizeof(glm::uvec3) +
         texcoords.size() * sizeof(glm::vec2) + colors.size() * sizeof(glm::u8vec3) +
         normals.size() * sizeof(glm::vec3) + values.size() * sizeof(float);
}

std::vector<std::string> valueNamesOf(const Json& primitive) {
  std::vector<std::string> names;
  for (const auto& [name, accessor] : GltfDocument::member(primitive, "attributes").items()) {
    if (name.starts_with('_')) names.push_back(name.substr(1));
    if (name == "COLOR_0") names.insert(names.end(), kChannels.begin(), kChannels.end());
  }
  return names;
}

std::optional<GltfPrimitive> readGltfPrimitive(const GltfDocument& document,
                                               const Json& primitive) {
  const std::size_t mode = document.number(primitive, "mode", kTriangles);
  if (mode < kTriangles) return std::nullopt;
  if (mode > kFan) throw document.bad("a mesh's 'mode' is " + std::to_string(mode));
  GltfPrimitive out;
  const std::size_t materials = document.array("materials").size();
  out.material = document.number(primitive, "material", materials);
  if (out.material != materials) (void)document.at("materials", out.material);
  std::string name = "TEXCOORD_" + std::to_string(texcoordSetOf(document, out.material));
  const auto [valueName, valueComponent] = valuesWanted(document, primitive);
  Attributes attributes(document, primitive,
                        {"POSITION", "NORMAL", "COLOR_0", "TEXCOORD_0", name, valueName});

  const GltfArray positions = attributes.take("POSITION").value();
  out.positions = positionsOf(document, positions);
  out.triangles =
      attributes.draco()
          ? unpackedTriangles(document, *attributes.draco(), positions.count)
          : trianglesOf(document, readIndices(document, primitive, positions.count), mode);

  std::optional<GltfArray> texcoords = attributes.take(name);
  if (!texcoords) texcoords = attributes.take(name = "TEXCOORD_0");
  if (texcoords) {
    requireLength(document, *texcoords, positions.count, 2, name);
    charge(document.file(), texcoords->count, sizeof(glm::vec2));
    out.texcoords.reserve(texcoords->count);
    for (std::size_t i = 0; i < texcoords->count; ++i) {  // v runs downwards
      const glm::vec2 at(texcoords->at(i, 0), 1.0f - static_cast<float>(texcoords->at(i, 1)));
      const bool finite = std::isfinite(at.x) && std::isfinite(at.y);
      out.texcoords.push_back(finite ? at : glm::vec2(0.0f));
    }
  }
  if (const std::optional<GltfArray> normals = attributes.take("NORMAL")) {
    requireLength(document, *normals, positions.count, 3, "NORMAL");
    charge(document.file(), normals->count, sizeof(glm::vec3));
    out.normals.reserve(normals->count);
    for (std::size_t i = 0; i < normals->count; ++i) {
      out.normals.emplace_back(normals->at(i, 0), normals->at(i, 1), normals->at(i, 2));
    }
  }
  const std::optional<GltfArray> colors = attributes.take("COLOR_0");
  if (!valueName.empty()) {
    out.values = valuesOf(document, valueName == "COLOR_0" ? colors : attributes.take(valueName),
                          positions.count, valueComponent, valueName);
  }
  if (colors) {
    requireLength(document, *colors, positions.count, 3, "COLOR_0");
    charge(document.file(), colors->count, sizeof(glm::u8vec3));
    out.colors.reserve(colors->count);
    for (std::size_t i = 0; i < colors->count; ++i) {
      out.colors.push_back(
          srgbFromLinear(glm::vec3(colors->at(i, 0), colors->at(i, 1), colors->at(i, 2))));
    }
  }
  return out;
}

}  // namespace sherd
