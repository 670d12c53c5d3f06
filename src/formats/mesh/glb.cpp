// Writes meshes as binary glTF 2.0.
//
//     magic, version 2, length | JSON chunk, padded with blanks | BIN chunk, padded with zeros
//
// Every buffer view begins at a multiple of four bytes, and holds one attribute, one list of
// indices, or one image.
#include <sherd/error.h>

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <numeric>

#include "base/little_endian.h"
#include "base/version.h"
#include "formats/mesh/piece_mesh.h"
#include "mesh/principal_inertia.h"

namespace sherd {
namespace {

using Json = nlohmann::ordered_json;

// glTF's constants for component types and for targets of buffer views.
constexpr int kUnsignedShort = 5123, kUnsignedInt = 5125, kFloat = 5126;
constexpr int kVertices = 34962, kIndices = 34963;
constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

class Buffer {
 public:
  // Begins a buffer view of all bytes that are stored until end().
  void begin() { from_ = bytes.size(); }
  std::size_t end(int target) {
    Json view = {{"buffer", 0}, {"byteOffset", from_}, {"byteLength", bytes.size() - from_}};
    if (target != 0) view["target"] = target;
    bytes.resize((bytes.size() + 3) / 4 * 4, '\0');
    views.push_back(std::move(view));
    return views.size() - 1;
  }
  // Adds an accessor of the whole view.
  std::size_t accessor(std::size_t view, int componentType, std::size_t count, const char* type) {
    accessors.push_back(
        {{"bufferView", view}, {"componentType", componentType}, {"count", count}, {"type", type}});
    return accessors.size() - 1;
  }

  std::string bytes;
  Json views = Json::array(), accessors = Json::array();

 private:
  std::size_t from_ = 0;
};

// sRGB bytes as linear light in 16 bits: 8 bits would merge dark colors.
std::array<std::uint16_t, 256> linearShorts() {
  std::array<std::uint16_t, 256> table{};
  for (std::size_t i = 0; i < table.size(); ++i) {
    const glm::u8vec3 gray(static_cast<std::uint8_t>(i));
    table[i] = static_cast<std::uint16_t>(linearFromSrgb(gray).x * 65535.0f + 0.5f);
  }
  return table;
}

// What all meshes of a file share.
struct Shared {
  explicit Shared(const MaterialTable& table)
      : textureNumbers(table.textures.size(), -1), materialNumbers(table.materials.size(), -1) {}

  Buffer buffer{};
  Json meshes = Json::array(), nodes = Json::array(), materials = Json::array(),
       textures = Json::array(), images = Json::array();
  std::vector<int> textureNumbers, materialNumbers;  // -1: not written yet
};

struct Writer {
  const PieceMesh& piece;
  Shared& shared;
  glm::dvec3 origin{0.0};  // of the node
  SplitCorners split = splitCorners(piece);
  bool colors = !piece.attributes.colors.empty();
  bool texcoords = !piece.attributes.texcoords.empty();
  Buffer& buffer = shared.buffer;
  std::vector<std::uint32_t> numberOf = std::vector<std::uint32_t>(split.corners.size(), kNone);

  // Returns the faces of a material as a primitive, or null if there are none.
  Json primitive(std::uint32_t material) {
    std::vector<std::uint32_t> used, indices;  // corners of the mesh; indices into them
    for (std::size_t t = 0; t < piece.mesh.triangles.size(); ++t) {
      if (piece.materialOf(t) != material) continue;
      for (const std::uint32_t corner : split.ofTriangle[t]) {
        if (numberOf[corner] == kNone) {
          numberOf[corner] = static_cast<std::uint32_t>(used.size());
          used.push_back(corner);
        }
        indices.push_back(numberOf[corner]);
      }
    }
    for (const std::uint32_t corner : used) numberOf[corner] = kNone;
    if (indices.empty()) return {};

    Json attributes = {{"POSITION", positions(used)}, {"NORMAL", normals(used)}};
    if (texcoords) attributes["TEXCOORD_0"] = texcoordsOf(used);
    if (colors) attributes["COLOR_0"] = colorsOf(used);
    attributes["_NEIGHBOR"] = neighbor(used);
    buffer.begin();
    for (const std::uint32_t index : indices) storeLittle(buffer.bytes, index);
    const std::size_t list =
        buffer.accessor(buffer.end(kIndices), kUnsignedInt, indices.size(), "SCALAR");
    int& number = shared.materialNumbers[material];
    if (number < 0) {
      shared.materials.push_back(materialJson(material));
      number = static_cast<int>(shared.materials.size()) - 1;
    }
    return {{"attributes", std::move(attributes)}, {"indices", list}, {"material", number}};
  }

  std::size_t positions(const std::vector<std::uint32_t>& used) {
    glm::vec3 low(std::numeric_limits<float>::infinity()), high(-low);
    buffer.begin();
    for (const std::uint32_t corner : used) {
      const glm::vec3 at(piece.mesh.vertices[split.corners[corner].vertex] - origin);
      for (int axis = 0; axis < 3; ++axis) {
        storeLittle(buffer.bytes, at[axis]);
        low[axis] = std::min(low[axis], at[axis]);
        high[axis] = std::max(high[axis], at[axis]);
      }
    }
    const std::size_t number = buffer.accessor(buffer.end(kVertices), kFloat, used.size(), "VEC3");
    buffer.accessors[number]["min"] = {low.x, low.y, low.z};
    buffer.accessors[number]["max"] = {high.x, high.y, high.z};
    return number;
  }

  std::size_t normals(const std::vector<std::uint32_t>& used) {
    buffer.begin();
    for (const std::uint32_t corner : used) {
      const glm::dvec3& normal = split.normals[split.corners[corner].normal];
      for (int axis = 0; axis < 3; ++axis) {
        storeLittle(buffer.bytes, static_cast<float>(normal[axis]));
      }
    }
    return buffer.accessor(buffer.end(kVertices), kFloat, used.size(), "VEC3");
  }

  // v runs downward in glTF.
  std::size_t texcoordsOf(const std::vector<std::uint32_t>& used) {
    buffer.begin();
    for (const std::uint32_t corner : used) {
      const glm::vec2& at = split.corners[corner].texcoord;
      storeLittle(buffer.bytes, at.x);
      storeLittle(buffer.bytes, 1.0f - at.y);
    }
    return buffer.accessor(buffer.end(kVertices), kFloat, used.size(), "VEC2");
  }

  std::size_t colorsOf(const std::vector<std::uint32_t>& used) {
    static const std::array<std::uint16_t, 256> linear = linearShorts();
    buffer.begin();
    for (const std::uint32_t corner : used) {
      const glm::u8vec3& color = split.corners[corner].color;
      for (int k = 0; k < 3; ++k) storeLittle(buffer.bytes, linear[color[k]]);
      storeLittle(buffer.bytes, std::uint16_t{65535});
    }
    const std::size_t number =
        buffer.accessor(buffer.end(kVertices), kUnsignedShort, used.size(), "VEC4");
    buffer.accessors[number]["normalized"] = true;
    return number;
  }

  // glTF allows 32-bit integers for indices only, and 16 bits would not fill four bytes.
  std::size_t neighbor(const std::vector<std::uint32_t>& used) {
    buffer.begin();
    for (const std::uint32_t corner : used) {
      storeLittle(buffer.bytes, static_cast<float>(split.corners[corner].neighbor));
    }
    return buffer.accessor(buffer.end(kVertices), kFloat, used.size(), "SCALAR");
  }

  Json materialJson(std::uint32_t number) {
    const MaterialTable::Entry& material = piece.materials.materials[number];
    glm::vec3 color = material.color;
    if (number == piece.materials.inside()) {  // vertex colors may already contain it
      color = colors ? glm::vec3(1.0f) : linearFromSrgb(kInsideColor);
    }
    Json surface = {{"baseColorFactor", {color.x, color.y, color.z, 1.0}},
                    {"metallicFactor", 0.0},
                    {"roughnessFactor", 1.0}};
    const int texture = texcoords ? textureNumber(material.texture) : -1;
    if (texture >= 0) surface["baseColorTexture"] = {{"index", texture}};
    return {{"name", material.name}, {"pbrMetallicRoughness", std::move(surface)}};
  }

  // Returns the number of a texture in the file, or -1: glTF supports only PNG and JPEG.
  int textureNumber(int texture) {
    if (texture < 0) return -1;
    const auto at = static_cast<std::size_t>(texture);
    const MaterialTable::Image& image = piece.materials.textures[at];
    int& number = shared.textureNumbers[at];
    if (image.type == ImageType::other || number >= 0) return number;
    buffer.begin();
    buffer.bytes += image.bytes;
    shared.images.push_back(
        {{"name", image.file},
         {"mimeType", image.type == ImageType::png ? "image/png" : "image/jpeg"},
         {"bufferView", buffer.end(0)}});
    shared.textures.push_back({{"source", shared.images.size() - 1}});
    return number = static_cast<int>(shared.textures.size()) - 1;
  }

  // Adds the mesh and returns a node with it.
  Json node() {
    Json primitives = Json::array();
    for (std::uint32_t m = 0; m < piece.materials.materials.size(); ++m) {
      Json one = primitive(m);
      if (!one.is_null()) primitives.push_back(std::move(one));
    }
    shared.meshes.push_back({{"name", piece.name}, {"primitives", std::move(primitives)}});
    return {{"name", piece.name}, {"mesh", shared.meshes.size() - 1}};
  }
};

constexpr const char* kPhysics = "KHR_physics_rigid_bodies";

Json motionJson(const MassProperties& mass, double density) {
  const PrincipalInertia inertia = principalInertia(mass);
  const glm::dvec3 moments = density * inertia.moments;
  const glm::dquat& rotation = inertia.orientation;
  return {{"mass", density * mass.volume},
          {"centerOfMass", {0.0, 0.0, 0.0}},
          {"inertiaDiagonal", {moments.x, moments.y, moments.z}},
          {"inertiaOrientation", {rotation.x, rotation.y, rotation.z, rotation.w}}};
}

Json documentOf(Shared& shared, bool hasPhysics) {
  std::vector<std::size_t> all(shared.nodes.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  Json json = {{"asset", {{"version", "2.0"}, {"generator", "Sherd " SHERD_VERSION}}}};
  if (hasPhysics) json["extensionsUsed"] = {kPhysics};
  json["scene"] = 0;
  json["scenes"] = Json::array({{{"nodes", all}}});
  json["nodes"] = std::move(shared.nodes);
  json["meshes"] = std::move(shared.meshes);
  json["materials"] = std::move(shared.materials);
  if (!shared.textures.empty()) {
    json["textures"] = std::move(shared.textures);
    json["images"] = std::move(shared.images);
  }
  json["accessors"] = std::move(shared.buffer.accessors);
  json["bufferViews"] = std::move(shared.buffer.views);
  json["buffers"] = Json::array({{{"byteLength", shared.buffer.bytes.size()}}});
  return json;
}

void storeChunk(std::string& bytes, const char* type, const std::string& content) {
  storeLittle(bytes, static_cast<std::uint32_t>(content.size()));
  bytes.append(type, 4).append(content);
}

void writeGlb(const OutputFile& file, Shared& shared, bool hasPhysics) {
  std::string text = documentOf(shared, hasPhysics).dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  const std::size_t length = 12 + 8 + text.size() + 8 + shared.buffer.bytes.size();
  if (length > std::numeric_limits<std::uint32_t>::max()) {
    throw Error(ErrorCode::output, file.string() + ": would have " + std::to_string(length) +
                                       " bytes; binary glTF holds less than 2^32");
  }
  std::string bytes = "glTF";
  storeLittle(bytes, std::uint32_t{2});
  storeLittle(bytes, static_cast<std::uint32_t>(length));
  storeChunk(bytes, "JSON", text);
  storeChunk(bytes, "BIN\0", shared.buffer.bytes);
  file.write(bytes);
}

}  // namespace

void writePieceGlb(const OutputFile& file, const PieceMesh& piece) {
  Shared shared(piece.materials);
  shared.nodes.push_back(Writer{.piece = piece, .shared = shared}.node());
  writeGlb(file, shared, false);
}

void writeSceneGlb(const OutputFile& file, std::span<const SceneNode> nodes, double density) {
  if (nodes.empty()) return;
  Shared shared(nodes.front().piece.materials);
  for (const SceneNode& one : nodes) {
    const glm::dvec3& center = one.mass.centroid;
    Json node = Writer{.piece = one.piece, .shared = shared, .origin = center}.node();
    node["translation"] = {center.x, center.y, center.z};
    node["extensions"] = {{kPhysics, {{"motion", motionJson(one.mass, density)}}}};
    shared.nodes.push_back(std::move(node));
  }
  writeGlb(file, shared, true);
}

}  // namespace sherd
