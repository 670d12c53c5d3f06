// A reader's result as bytes that two programs of one build exchange.
//
//   "sherd mesh 3"  arrays and texts one after another  "end"
//   an array: 8 bytes, its length; then its elements as in memory
#include "formats/mesh/mesh_stream.h"

#include <cmath>
#include <cstdint>
#include <type_traits>
#include <utility>

#include "base/files/byte_source.h"
#include "formats/mesh/contradictions.h"

namespace sherd {
namespace {

constexpr std::string_view kBegin = "sherd mesh 3", kEnd = "end";
constexpr double kNotSaid = 0.0;  // of the meters per unit
constexpr std::size_t kCount = ByteSource::kCountBytes;

template <class Element>
void put(std::string& out, const std::vector<Element>& elements) {
  static_assert(std::is_trivially_copyable_v<Element>);
  const std::uint64_t count = elements.size();
  out.append(reinterpret_cast<const char*>(&count), sizeof count);
  out.append(reinterpret_cast<const char*>(elements.data()), count * sizeof(Element));
}

void put(std::string& out, std::string_view text) {
  put(out, std::vector<char>(text.begin(), text.end()));
}

void put(std::string& out, const std::vector<std::string>& texts) {
  put(out, std::vector<std::uint64_t>{texts.size()});
  for (const std::string& text : texts) put(out, text);
}

}  // namespace

std::string streamOf(const RawMesh& mesh) {
  std::string out(kBegin);
  put(out, mesh.vertices);
  put(out, mesh.triangles);
  put(out, mesh.attributes.texcoords);
  put(out, mesh.attributes.colors);
  put(out, mesh.attributes.material);
  put(out, mesh.attributes.normals);
  put(out, std::vector<std::uint64_t>{mesh.appearance.materials.size()});
  for (const Material& material : mesh.appearance.materials) {
    put(out, material.name);
    put(out, std::vector<glm::vec3>{material.color});
    put(out, std::vector<int>{material.texture});
  }
  put(out, std::vector<std::uint64_t>{mesh.appearance.textures.size()});
  for (const Texture& texture : mesh.appearance.textures) {
    put(out, texture.name);
    put(out, texture.bytes);
  }
  put(out, mesh.objects);
  put(out, mesh.objectOfTriangle);
  put(out, mesh.polygons);
  put(out, mesh.warnings);
  put(out, std::vector<double>{mesh.metersPerUnit.value_or(kNotSaid)});
  put(out, std::vector<char>{mesh.up.value_or('\0')});
  return out.append(kEnd);
}

std::optional<RawMesh> meshFromStream(std::string_view stream, MemoryBudget* memory) {
  if (!stream.starts_with(kBegin)) return std::nullopt;
  ByteSource source(stream.substr(kBegin.size()), memory);
  RawMesh mesh;
  source.take(mesh.vertices);
  source.take(mesh.triangles);
  source.take(mesh.attributes.texcoords);
  source.take(mesh.attributes.colors);
  source.take(mesh.attributes.material);
  source.take(mesh.attributes.normals);
  source.makeRoom(mesh.appearance.materials, 3 * kCount + sizeof(glm::vec3) + sizeof(int));
  for (Material& material : mesh.appearance.materials) {
    source.take(material.name);
    source.takeOne(material.color);
    source.takeOne(material.texture);
  }
  source.makeRoom(mesh.appearance.textures, 2 * kCount);
  for (Texture& texture : mesh.appearance.textures) {
    source.take(texture.name);
    source.take(texture.bytes);
  }
  source.take(mesh.objects);
  source.take(mesh.objectOfTriangle);
  source.take(mesh.polygons);
  source.take(mesh.warnings);
  double metersPerUnit = kNotSaid;
  char up = '\0';
  source.takeOne(metersPerUnit);
  source.takeOne(up);
  if (std::isfinite(metersPerUnit) && metersPerUnit > 0.0) mesh.metersPerUnit = metersPerUnit;
  if (up >= 'x' && up <= 'z') mesh.up = up;
  if (!source.isAt(kEnd) || contradictionIn(mesh)) return std::nullopt;
  return mesh;
}

}  // namespace sherd
