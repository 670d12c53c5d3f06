// The meshes of a glTF file that is written.
#include "formats/gltf/glb_mesh.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "base/little_endian.h"

namespace sherd {
namespace {

using OrderedJson = GlbFile::Json;

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
constexpr std::size_t kShortIndices = 65535;  // vertices; the largest index means something else

// sRGB bytes as linear light in 16 bits: 8 bits would merge dark colors.
std::array<std::uint16_t, 256> linearShorts() {
  std::array<std::uint16_t, 256> table{};
  for (std::size_t i = 0; i < table.size(); ++i) {
    const glm::u8vec3 gray(static_cast<std::uint8_t>(i));
    table[i] = static_cast<std::uint16_t>(linearFromSrgb(gray).x * 65535.0f + 0.5f);
  }
  return table;
}

// The corners of a mesh that are its vertices.
SplitCorners wholeCorners(const TriangleMesh& mesh) {
  SplitCorners split;
  split.corners.resize(mesh.vertices.size());
  for (std::uint32_t i = 0; i < mesh.vertices.size(); ++i) split.corners[i].vertex = i;
  for (const glm::uvec3& t : mesh.triangles) split.ofTriangle.push_back({t.x, t.y, t.z});
  return split;
}

class MeshWriter {
 public:
  //   split  of the mesh
  MeshWriter(GlbFile& file, const TriangleMesh& mesh, const glm::dvec3& origin, SplitCorners split)
      : file_(file),
        mesh_(mesh),
        origin_(origin),
        split_(std::move(split)),
        indexType_(split_.corners.size() <= kShortIndices ? kGltfUnsignedShort : kGltfUnsignedInt),
        order_(mesh.triangles.size()) {
    std::iota(order_.begin(), order_.end(), 0u);
  }

  std::size_t add(GlbMaterials& materials, const PieceMesh& piece) {
    std::stable_sort(order_.begin(), order_.end(), [&](std::uint32_t a, std::uint32_t b) {
      return piece.materialOf(a) < piece.materialOf(b);
    });
    OrderedJson attributes = {{"POSITION", positions()}, {"NORMAL", normals()}};
    if (!piece.attributes.texcoords.empty()) attributes["TEXCOORD_0"] = texcoords();
    if (!piece.attributes.colors.empty()) attributes["COLOR_0"] = colors();
    attributes["_NEIGHBOR"] = neighbor();
    const std::size_t indices = indexView();
    OrderedJson primitives = OrderedJson::array();
    for (std::size_t first = 0; first < order_.size();) {
      const std::uint32_t material = piece.materialOf(order_[first]);
      std::size_t end = first;
      while (end < order_.size() && piece.materialOf(order_[end]) == material) ++end;
      OrderedJson one = primitive(attributes, indices, first, end);
      one["material"] = materials.numberOf(material, piece.attributes);
      primitives.push_back(std::move(one));
      first = end;
    }
    return addMesh(piece.name, std::move(primitives), attributes["POSITION"], indices);
  }

  std::size_t addPlain(const std::string& name) {
    const OrderedJson attributes = {{"POSITION", positions()}};
    const std::size_t indices = indexView();
    return addMesh(name, OrderedJson::array({primitive(attributes, indices, 0, order_.size())}),
                   attributes["POSITION"], indices);
  }

 private:
  // The triangles from the first to before the end, in order_.
  OrderedJson primitive(const OrderedJson& attributes, std::size_t indices, std::size_t first,
                        std::size_t end) {
    const std::size_t list = file_.accessor(indices, indexType_, 3 * (end - first), "SCALAR");
    if (first > 0) file_.accessors[list]["byteOffset"] = 3 * first * indexBytes();
    return {{"attributes", attributes}, {"indices", list}};
  }

  std::size_t addMesh(const std::string& name, OrderedJson primitives, std::size_t positions,
                      std::size_t indices) {
    OrderedJson mesh = {{"name", name}, {"primitives", std::move(primitives)}};
    if (!order_.empty() && nonManifoldEdges(mesh_) == 0) {
      mesh["extensions"] = {{"EXT_mesh_manifold", manifold(positions, indices)}};
      file_.extensionsUsed.insert("EXT_mesh_manifold");
    }
    file_.meshes.push_back(std::move(mesh));
    return file_.meshes.size() - 1;
  }

  [[nodiscard]] std::size_t indexBytes() const { return indexType_ == kGltfUnsignedInt ? 4 : 2; }

  // The number in the list of indices of corner i is that of the corner in the mesh.
  [[nodiscard]] std::uint32_t cornerAt(std::size_t i) const {
    return split_.ofTriangle[order_[i / 3]][i % 3];
  }

  void storeIndex(std::uint32_t index) {
    if (indexType_ == kGltfUnsignedInt) {
      storeLittle(file_.bytes, index);
    } else {
      storeLittle(file_.bytes, static_cast<std::uint16_t>(index));
    }
  }

  std::size_t indexView() {
    file_.begin();
    for (std::size_t i = 0; i < 3 * order_.size(); ++i) storeIndex(cornerAt(i));
    return file_.end(kGltfIndices);
  }

  std::size_t vertexAccessor(int componentType, const char* type, int stride = 0) {
    return file_.accessor(file_.end(kGltfVertices, stride), componentType, split_.corners.size(),
                          type);
  }

  std::size_t positions() {
    glm::vec3 low(std::numeric_limits<float>::infinity()), high(-low);
    file_.begin();
    for (const SplitCorners::Corner& corner : split_.corners) {
      const glm::vec3 at(mesh_.vertices[corner.vertex] - origin_);
      for (int axis = 0; axis < 3; ++axis) {
        storeLittle(file_.bytes, at[axis]);
        low[axis] = std::min(low[axis], at[axis]);
        high[axis] = std::max(high[axis], at[axis]);
      }
    }
    const std::size_t number = vertexAccessor(kGltfFloat, "VEC3");
    file_.accessors[number]["min"] = {low.x, low.y, low.z};
    file_.accessors[number]["max"] = {high.x, high.y, high.z};
    return number;
  }

  std::size_t normals() {
    file_.begin();
    for (const SplitCorners::Corner& corner : split_.corners) {
      const glm::dvec3& normal = split_.normals[corner.normal];
      for (int axis = 0; axis < 3; ++axis) {
        storeLittle(file_.bytes, static_cast<float>(normal[axis]));
      }
    }
    return vertexAccessor(kGltfFloat, "VEC3");
  }

  // v runs downward in glTF.
  std::size_t texcoords() {
    file_.begin();
    for (const SplitCorners::Corner& corner : split_.corners) {
      storeLittle(file_.bytes, corner.texcoord.x);
      storeLittle(file_.bytes, 1.0f - corner.texcoord.y);
    }
    return vertexAccessor(kGltfFloat, "VEC2");
  }

  std::size_t colors() {
    static const std::array<std::uint16_t, 256> linear = linearShorts();
    file_.begin();
    for (const SplitCorners::Corner& corner : split_.corners) {
      for (int k = 0; k < 3; ++k) storeLittle(file_.bytes, linear[corner.color[k]]);
      storeLittle(file_.bytes, std::uint16_t{65535});
    }
    const std::size_t number = vertexAccessor(kGltfUnsignedShort, "VEC4");
    file_.accessors[number]["normalized"] = true;
    return number;
  }

  // glTF allows 32-bit integers for indices only, and aligns vertices to four bytes.
  std::size_t neighbor() {
    file_.begin();
    for (const SplitCorners::Corner& corner : split_.corners) {
      storeLittle(file_.bytes, corner.neighbor);
      storeLittle(file_.bytes, std::uint16_t{0});
    }
    return vertexAccessor(kGltfUnsignedShort, "SCALAR", 4);
  }

  // The same list of indices, with the first of those that have one vertex in place of each other.
  OrderedJson manifold(std::size_t positions, std::size_t indices) {
    std::vector<std::uint32_t> firstOf(mesh_.vertices.size(), kNone);
    std::vector<std::uint32_t> merged;  // places in the list
    for (std::size_t i = 0; i < 3 * order_.size(); ++i) {
      const std::uint32_t corner = cornerAt(i);
      std::uint32_t& first = firstOf[split_.corners[corner].vertex];
      if (first == kNone) first = corner;
      if (first != corner) merged.push_back(static_cast<std::uint32_t>(i));
    }
    const std::size_t all = file_.accessor(indices, indexType_, 3 * order_.size(), "SCALAR");
    OrderedJson extension = {
        {"manifoldPrimitive",
         {{"mode", 4}, {"attributes", {{"POSITION", positions}}}, {"indices", all}}}};
    if (merged.empty()) return extension;
    file_.begin();
    for (const std::uint32_t place : merged) storeLittle(file_.bytes, place);
    const std::size_t places = file_.end(kGltfNoTarget);
    file_.begin();
    for (const std::uint32_t place : merged) {
      storeIndex(firstOf[split_.corners[cornerAt(place)].vertex]);
    }
    const std::size_t values = file_.end(kGltfNoTarget);
    file_.accessors[all]["sparse"] = {
        {"count", merged.size()},
        {"indices", {{"bufferView", places}, {"componentType", kGltfUnsignedInt}}},
        {"values", {{"bufferView", values}}}};
    extension["mergeIndices"] = file_.accessor(places, kGltfUnsignedInt, merged.size(), "SCALAR");
    extension["mergeValues"] = file_.accessor(values, indexType_, merged.size(), "SCALAR");
    return extension;
  }

  GlbFile& file_;
  const TriangleMesh& mesh_;
  const glm::dvec3 origin_;
  const SplitCorners split_;
  const int indexType_;
  std::vector<std::uint32_t> order_;  // triangles, those of one material together
};

}  // namespace

std::size_t addGlbMesh(GlbFile& file, GlbMaterials& materials, const PieceMesh& piece,
                       const glm::dvec3& origin) {
  return MeshWriter(file, piece.mesh, origin, splitCorners(piece)).add(materials, piece);
}

std::size_t addPlainGlbMesh(GlbFile& file, const std::string& name, const TriangleMesh& mesh,
                            const glm::dvec3& origin) {
  return MeshWriter(file, mesh, origin, wholeCorners(mesh)).addPlain(name);
}

}  // namespace sherd
