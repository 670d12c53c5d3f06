// A reader's result as bytes that two programs of one build exchange.
//
//   "sherd mesh 2"  arrays and texts one after another  "end"
//   an array: 8 bytes, its length; then its elements as in memory
#include "formats/mesh/mesh_stream.h"

#include <cstdint>
#include <cstring>
#include <type_traits>
#include <utility>

#include "formats/mesh/contradictions.h"

namespace sherd {
namespace {

constexpr std::string_view kBegin = "sherd mesh 2", kEnd = "end";
constexpr std::size_t kCount = sizeof(std::uint64_t);  // bytes of an array's length

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

// Reads from the front of a stream; good() is false once the stream was too short.
class Source {
 public:
  Source(std::string_view bytes, MemoryBudget* memory) : bytes_(bytes), memory_(memory) {}
  bool good() const { return good_; }
  bool isAt(std::string_view end) const { return good_ && bytes_ == end; }

  std::uint64_t takeCount() {
    std::uint64_t count = 0;
    good_ = good_ && bytes_.size() >= sizeof count;
    if (!good_) return 0;
    std::memcpy(&count, bytes_.data(), sizeof count);
    bytes_.remove_prefix(sizeof count);
    return count;
  }

  template <class Element>
  void take(std::vector<Element>& elements) {
    const std::uint64_t count = takeCount();
    good_ = good_ && count <= bytes_.size() / sizeof(Element);
    if (!good_) return;
    elements.resize(count);
    if (count > 0) std::memcpy(elements.data(), bytes_.data(), count * sizeof(Element));
    bytes_.remove_prefix(count * sizeof(Element));
  }

  void take(std::string& text) {
    std::vector<char> characters;
    take(characters);
    text.assign(characters.begin(), characters.end());
  }

  // Reads the number of elements that follow and allocates them.
  //   leastBytes  of an element in the stream; it may take more in memory
  template <class Element>
  void makeRoom(std::vector<Element>& elements, std::size_t leastBytes) {
    std::vector<std::uint64_t> number;
    take(number);
    good_ = good_ && number.size() == 1 && number[0] <= bytes_.size() / leastBytes;
    if (!good_) return;
    if (memory_ != nullptr) memory_->charge(number[0], sizeof(Element));
    elements.resize(number[0]);
  }

  void take(std::vector<std::string>& texts) {
    makeRoom(texts, kCount);
    for (std::string& text : texts) take(text);
  }

 private:
  std::string_view bytes_;
  MemoryBudget* memory_;
  bool good_ = true;
};

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
  return out.append(kEnd);
}

std::optional<RawMesh> meshFromStream(std::string_view stream, MemoryBudget* memory) {
  if (!stream.starts_with(kBegin)) return std::nullopt;
  Source source(stream.substr(kBegin.size()), memory);
  RawMesh mesh;
  source.take(mesh.vertices);
  source.take(mesh.triangles);
  source.take(mesh.attributes.texcoords);
  source.take(mesh.attributes.colors);
  source.take(mesh.attributes.material);
  source.take(mesh.attributes.normals);
  source.makeRoom(mesh.appearance.materials, 3 * kCount + sizeof(glm::vec3) + sizeof(int));
  for (Material& material : mesh.appearance.materials) {
    std::vector<glm::vec3> color;
    std::vector<int> texture;
    source.take(material.name);
    source.take(color);
    source.take(texture);
    if (color.size() != 1 || texture.size() != 1) return std::nullopt;
    material.color = color[0];
    material.texture = texture[0];
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
  if (!source.isAt(kEnd) || contradictionIn(mesh)) return std::nullopt;
  return mesh;
}

}  // namespace sherd
