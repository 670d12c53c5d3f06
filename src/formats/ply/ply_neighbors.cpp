// Other neighbors in a PLY file of a fragment, and nothing else.
#include "formats/ply/ply_neighbors.h"

#include <sherd/error.h>

#include <utility>

#include "base/little_endian.h"
#include "formats/ply/ply_body.h"

namespace sherd {
namespace {

// Goes through the records of a file's body.
class Patch {
 public:
  Patch(MeshFile& file, const PlyHeader& header) : bytes_(file.bytes), at_(header.bodyAt) {}

  // Sets the neighbor of the next record.  Returns its number of corners, 0 for a vertex; nothing
  // where the file ends.
  //   neighbor  with the record's number of triangles behind it, the first counts
  std::optional<std::size_t> set(const PlyElement& element, std::span<const std::uint16_t> from) {
    std::size_t corners = 0;
    for (const PlyProperty& property : element.properties) {
      std::size_t size = property.value.bytes;
      if (property.listCount) {
        if (property.listCount->bytes != 1 || !has(1)) return {};
        const auto count = static_cast<std::size_t>(static_cast<unsigned char>(bytes_[at_]));
        if (property.name == "vertex_indices") corners = count;
        size = 1 + count * property.value.bytes;
      }
      if (!has(size)) return {};
      if (property.name == "neighbor") {
        if (size != 4 || from.empty()) return {};
        keepLittle(bytes_.data() + at_, std::uint32_t{from.front()});
      }
      at_ += size;
    }
    return corners;
  }

  [[nodiscard]] bool isAtEnd() const { return at_ == bytes_.size(); }

 private:
  [[nodiscard]] bool has(std::size_t size) const { return bytes_.size() - at_ >= size; }

  std::string& bytes_;
  std::size_t at_;
};

bool hasNeighbor(const PlyElement& element) {
  for (const PlyProperty& property : element.properties) {
    if (property.name == "neighbor") return !property.listCount;
  }
  return false;
}

}  // namespace

std::optional<std::string> withNeighbors(std::string ply, std::span<const std::uint16_t> ofVertex,
                                         std::span<const std::uint16_t> ofTriangle) {
  MeshFile file{.path = {}, .name = "", .format = MeshFormat::ply, .bytes = std::move(ply)};
  PlyHeader header;
  try {
    header = readPlyHeader(file);
  } catch (const Error&) {
    return {};
  }
  if (header.encoding != PlyEncoding::littleEndian || header.elements.size() != 2) return {};
  const PlyElement &vertices = header.elements[0], &faces = header.elements[1];
  if (vertices.name != "vertex" || faces.name != "face" || vertices.count != ofVertex.size() ||
      !hasNeighbor(vertices) || !hasNeighbor(faces)) {
    return {};
  }
  Patch patch(file, header);
  for (std::size_t v = 0; v < vertices.count; ++v) {
    if (!patch.set(vertices, ofVertex.subspan(v))) return {};
  }
  std::size_t t = 0;
  for (std::size_t f = 0; f < faces.count; ++f) {
    const std::optional<std::size_t> corners = patch.set(faces, ofTriangle.subspan(t));
    if (!corners || *corners < 3 || ofTriangle.size() - t < *corners - 2) return {};
    t += *corners - 2;
  }
  if (t != ofTriangle.size() || !patch.isAtEnd()) return {};
  return std::move(file.bytes);
}

}  // namespace sherd
