// Reads glTF files: the meshes of the default scene, node transforms applied.
#include "formats/gltf/read_gltf.h"

#include <algorithm>
#include <array>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <optional>
#include <string>
#include <utility>

#include "base/text/text_scan.h"
#include "formats/gltf/gltf_accessor.h"
#include "formats/gltf/gltf_attributes.h"
#include "formats/gltf/gltf_document.h"
#include "formats/gltf/gltf_primitive.h"
#include "formats/gltf/gltf_root.h"
#include "formats/gltf/gltf_transforms.h"
#include "formats/mesh/normals.h"

namespace sherd {
namespace {

using Json = GltfDocument::Json;

constexpr std::size_t kDeepestNode = 1000;
// Nodes and instances multiply the meshes of a file; more than this is refused as hostile.
constexpr std::size_t kMostInScene = std::size_t{1} << 28;  // vertices, and corners of triangles

// world = linear * local + offset.
struct Affine {
  glm::dmat3 linear{1.0};
  glm::dvec3 offset{0.0};

  Affine operator*(const Affine& inner) const {
    return {linear * inner.linear, linear * inner.offset + offset};
  }
  // The identity is not applied: 0 * inf would turn one infinite coordinate into three NaNs.
  bool moves() const { return linear != glm::dmat3(1.0) || offset != glm::dvec3(0.0); }
};

// The rotation is a quaternion x y z w of any length.
Affine composed(const glm::dvec3& translation, const std::array<double, 4>& rotation,
                const glm::dvec3& scale) {
  const glm::dquat q(rotation[3], rotation[0], rotation[1], rotation[2]);
  const double length = glm::length(q);
  glm::dmat3 linear = length > 0.0 ? glm::mat3_cast(q / length) : glm::dmat3(1.0);
  for (int axis = 0; axis < 3; ++axis) linear[axis] *= scale[axis];
  return {linear, translation};
}

template <std::size_t count>
std::optional<std::array<double, count>> numbersOf(const GltfDocument& document, const Json& node,
                                                   const char* name) {
  const auto found = node.find(name);
  if (found == node.end()) return std::nullopt;
  if (!found->is_array() || found->size() != count)
    throw document.bad("a node's '" + std::string(name) + "' is not of " + std::to_string(count) +
                       " numbers");
  return found->get<std::array<double, count>>();
}

Affine localOf(const GltfDocument& document, const Json& node) {
  if (const auto m = numbersOf<16>(document, node, "matrix")) {  // column by column
    const auto& a = *m;
    return {glm::dmat3(a[0], a[1], a[2], a[4], a[5], a[6], a[8], a[9], a[10]),
            glm::dvec3(a[12], a[13], a[14])};
  }
  const auto t = numbersOf<3>(document, node, "translation");
  const auto r = numbersOf<4>(document, node, "rotation");
  const auto s = numbersOf<3>(document, node, "scale");
  return composed(t ? glm::dvec3((*t)[0], (*t)[1], (*t)[2]) : glm::dvec3(0.0),
                  r.value_or(std::array<double, 4>{0.0, 0.0, 0.0, 1.0}),
                  s ? glm::dvec3((*s)[0], (*s)[1], (*s)[2]) : glm::dvec3(1.0));
}

const Json& instancing(const Json& node) {
  const Json& extension =
      GltfDocument::member(GltfDocument::member(node, "extensions"), "EXT_mesh_gpu_instancing");
  return GltfDocument::member(extension, "attributes");
}

// Returns the number of instances of a node's mesh.
std::size_t instanceCount(const GltfDocument& document, const Json& node) {
  for (const char* name : {"TRANSLATION", "ROTATION", "SCALE"}) {
    if (!instancing(node).contains(name)) continue;
    const std::size_t index = document.number(instancing(node), name);
    return document.number(document.at("accessors", index), "count");
  }
  return 1;
}

// Returns the instance transforms of EXT_mesh_gpu_instancing in the node's space; the identity if
// the node has none.
std::vector<Affine> instancesOf(const GltfDocument& document, const Json& node) {
  const Json& attributes = instancing(node);
  std::optional<std::size_t> count;
  const auto read = [&](const char* name, std::size_t components) -> std::optional<GltfArray> {
    if (!attributes.contains(name)) return std::nullopt;
    GltfArray array = readGltfArray(document, document.number(attributes, name));
    if (array.components != components || (count && *count != array.count))
      throw document.bad("the arrays of a node's instances differ in length or type");
    count = array.count;
    return array;
  };
  const auto t = read("TRANSLATION", 3), r = read("ROTATION", 4), s = read("SCALE", 3);
  if (!count) return {Affine{}};
  charge(document.file(), *count, sizeof(Affine));
  std::vector<Affine> out;
  out.reserve(*count);
  for (std::size_t i = 0; i < *count; ++i) {
    const auto triple = [&](const std::optional<GltfArray>& array, double otherwise) {
      return array ? glm::dvec3(array->at(i, 0), array->at(i, 1), array->at(i, 2))
                   : glm::dvec3(otherwise);
    };
    std::array<double, 4> rotation{0.0, 0.0, 0.0, 1.0};
    for (std::size_t k = 0; k < 4 && r; ++k) rotation[k] = r->at(i, k);
    out.push_back(composed(triple(t, 0.0), rotation, triple(s, 1.0)));
  }
  return out;
}

std::vector<std::size_t> indicesOf(const GltfDocument& document, const Json& object,
                                   const char* name) {
  const std::size_t count = document.array("nodes").size();
  std::vector<std::size_t> out;
  for (const Json& value : GltfDocument::member(object, name)) {
    if (!value.is_number_unsigned() || value.get<std::uint64_t>() >= count)
      throw document.bad("refers to node " + plainText(value.dump().substr(0, 40)) +
                         ", the file has " + std::to_string(count));
    out.push_back(value.get<std::size_t>());
  }
  return out;
}

// Returns the nodes without a parent. Nodes must form trees: a cycle would be walked forever.
std::vector<std::size_t> rootsOf(const GltfDocument& document) {
  const Json& nodes = document.array("nodes");
  std::vector<bool> isChild(nodes.size(), false);
  for (const Json& node : nodes) {
    for (const std::size_t child : indicesOf(document, node, "children")) {
      if (isChild[child])
        throw document.bad("node " + std::to_string(child) + " has more than one parent");
      isChild[child] = true;
    }
  }
  std::vector<std::size_t> roots;
  for (std::size_t i = 0; i < nodes.size(); ++i)
    if (!isChild[i]) roots.push_back(i);
  std::size_t reached = 0;
  std::vector<std::size_t> level = roots;
  for (std::size_t depth = 0; !level.empty(); ++depth) {
    if (depth > kDeepestNode) throw document.bad("its nodes are nested too deeply");
    reached += level.size();
    std::vector<std::size_t> below;
    for (const std::size_t i : level)
      for (const std::size_t child : indicesOf(document, nodes[i], "children"))
        below.push_back(child);
    level = std::move(below);
  }
  if (reached != nodes.size()) throw document.bad("a node lies within itself");
  return roots;
}

// A node with a mesh, and its transform.
struct MeshNode {
  std::size_t node;
  std::size_t mesh;
  Affine world;
};

// Returns the nodes of the default scene.
std::vector<std::size_t> sceneNodes(const GltfDocument& document) {
  std::vector<std::size_t> roots = rootsOf(document);  // which refuses circles
  const Json& scenes = document.array("scenes");
  for (const Json& scene : scenes) (void)indicesOf(document, scene, "nodes");
  if (scenes.empty()) return roots;
  const std::size_t scene = document.number(document.root(), "scene");
  return indicesOf(document, document.at("scenes", scene), "nodes");
}

// Returns the coordinates of the input that a file of ours holds below its root node.
std::optional<CoordinateSystem> ownCoordinates(const GltfDocument& document) {
  const std::vector<std::size_t> roots = sceneNodes(document);
  if (roots.size() != 1) return {};
  return coordinatesBelow(GltfDocument::member(document.root(), "asset"),
                          document.at("nodes", roots.front()));
}

// Returns the nodes with a mesh, each once, in depth-first order of the default scene.
//   isOwn  the root's transform is that of ownCoordinates, and is not applied
std::vector<MeshNode> findMeshNodes(const GltfDocument& document, bool isOwn) {
  const std::vector<std::size_t> roots = sceneNodes(document);
  struct Visit {
    std::size_t node;
    Affine parent;
  };
  std::vector<Visit> stack;
  for (auto root = roots.rbegin(); root != roots.rend(); ++root) stack.push_back({*root, {}});
  std::vector<bool> seen(document.array("nodes").size(), false);
  std::vector<MeshNode> out;
  while (!stack.empty()) {
    const Visit visit = stack.back();
    stack.pop_back();
    if (seen[visit.node]) continue;
    seen[visit.node] = true;
    const Json& node = document.at("nodes", visit.node);
    const Affine local = localOf(document, node);
    const bool isRoot = isOwn && visit.node == roots.front();
    const Affine world = isRoot ? Affine{} : visit.parent * local;
    if (node.contains("mesh")) out.push_back({visit.node, document.number(node, "mesh"), world});
    const std::vector<std::size_t> children = indicesOf(document, node, "children");
    for (auto child = children.rbegin(); child != children.rend(); ++child)
      stack.push_back({*child, world});
  }
  return out;
}

struct Reader {
  const GltfDocument& document;
  std::optional<CoordinateSystem> below = ownCoordinates(document);
  std::vector<MeshNode> meshNodes = findMeshNodes(document, below.has_value());
  std::vector<std::optional<std::vector<GltfPrimitive>>> meshes{document.array("meshes").size()};
  std::size_t pointsAndLines = 0;
  bool hasTexcoords = false, hasColors = false, hasNormals = false, hasValues = false;
  bool morphed = false;
  std::vector<std::uint32_t> materials{};  // indices in `out` of the file's materials, or empty
  RawMesh out{};

  // Intermediate arrays are charged while they exist.
  std::optional<GltfPrimitive> decoded(const Json& source) const {
    const TransientMemory transient(document.file().memory);
    return readGltfPrimitive(document, source);
  }

  void addValueNames(const Json& primitive) {
    if (document.file().attribute.empty()) return;
    for (const std::string& name : valueNamesOf(primitive)) {
      if (std::find(out.valueNames.begin(), out.valueNames.end(), name) == out.valueNames.end()) {
        out.valueNames.push_back(name);
      }
    }
  }

  void decodeMeshes() {
    std::vector<bool> used(document.array("materials").size() + 1, false);
    for (const MeshNode& node : meshNodes) {
      const Json& mesh = document.at("meshes", node.mesh);
      if (meshes[node.mesh]) continue;
      std::vector<GltfPrimitive>& primitives = meshes[node.mesh].emplace();
      for (const Json& source : GltfDocument::member(mesh, "primitives")) {
        checkpoint(document.file());
        morphed = morphed || source.contains("targets");
        std::optional<GltfPrimitive> primitive = decoded(source);
        if (!primitive) {
          ++pointsAndLines;
          continue;
        }
        charge(document.file(), primitive->bytes());
        hasTexcoords |= !primitive->texcoords.empty();
        hasColors |= !primitive->colors.empty();
        hasNormals |= !primitive->normals.empty();
        hasValues |= !primitive->values.empty();
        addValueNames(source);
        used[primitive->material] = true;
        if (primitive->positions.empty()) continue;  // its instances would add nothing
        primitives.push_back(std::move(*primitive));
      }
    }
    materials = addMaterials(document, used, hasTexcoords, out);
  }

  // Colors default to white, texture coordinates, normals and values to 0 if only other primitives
  // have them.
  void append(const GltfPrimitive& primitive, const Affine& world) {
    const auto first = static_cast<std::uint32_t>(out.vertices.size());
    const bool moves = world.moves();
    for (const glm::dvec3& v : primitive.positions)
      out.vertices.push_back(moves ? world.linear * v + world.offset : v);
    if (hasValues) {
      out.values.insert(out.values.end(), primitive.values.begin(), primitive.values.end());
      out.values.resize(out.vertices.size(), 0.0f);
    }
    const bool mirrored = glm::determinant(world.linear) < 0.0;
    const glm::dmat3 ofNormals = normalTransform(world.linear);
    const auto moved = [&](const glm::vec3& normal) {
      return moves ? transformedNormal(ofNormals, normal) : normal;
    };
    SurfaceAttributes& attributes = out.attributes;
    for (glm::uvec3 t : primitive.triangles) {
      if (mirrored) std::swap(t.x, t.z);
      out.triangles.push_back(t + first);
      const auto atCorners = [&]<class Value>(const std::vector<Value>& values, Value otherwise) {
        return values.empty() ? std::array<Value, 3>{otherwise, otherwise, otherwise}
                              : std::array<Value, 3>{values[t.x], values[t.y], values[t.z]};
      };
      if (hasTexcoords)
        attributes.texcoords.push_back(atCorners(primitive.texcoords, glm::vec2(0.0f)));
      if (hasColors) attributes.colors.push_back(atCorners(primitive.colors, glm::u8vec3(255)));
      if (hasNormals) {
        std::array<glm::vec3, 3>& normals =
            attributes.normals.emplace_back(atCorners(primitive.normals, glm::vec3(0.0f)));
        for (glm::vec3& normal : normals) normal = moved(normal);
      }
      if (!materials.empty()) attributes.material.push_back(materials[primitive.material]);
    }
  }

  std::string nameOf(const MeshNode& node) const {
    const std::string name = document.at("nodes", node.node).value("name", std::string());
    return name.empty() ? document.at("meshes", node.mesh).value("name", name) : name;
  }

  // Reserves memory for the whole scene after checking the limits: nodes and instances multiply the
  // meshes of a file.
  void makeRoom() {
    struct Size {
      std::size_t vertices = 0, triangles = 0;
    };
    std::vector<Size> own(meshes.size());
    for (std::size_t i = 0; i < meshes.size(); ++i) {
      if (!meshes[i]) continue;
      for (const GltfPrimitive& primitive : *meshes[i]) {
        own[i].vertices += primitive.positions.size();
        own[i].triangles += primitive.triangles.size();
      }
    }
    std::size_t vertices = 0, triangles = 0;
    for (const MeshNode& node : meshNodes) {
      const std::size_t count = instanceCount(document, document.at("nodes", node.node));
      vertices += count * own[node.mesh].vertices;
      triangles += count * own[node.mesh].triangles;
      if (std::max(vertices, 3 * triangles) <= kMostInScene) continue;
      throw document.bad("its nodes show more than " + std::to_string(kMostInScene) +
                         " vertices or corners of triangles, which is more than is read");
    }
    const MeshFile& file = document.file();
    for (const MeshNode& node : meshNodes) {  // each has a name, its own or its mesh's
      checkpoint(file);
      charge(file, nameOf(node).size() + sizeof(std::string));
    }
    out.objects.reserve(meshNodes.size());
    SurfaceAttributes& attributes = out.attributes;
    const auto reserve = [&]<class Value>(std::vector<Value>& values, std::size_t count) {
      charge(file, count, sizeof(Value));
      values.reserve(count);
    };
    reserve(out.vertices, vertices);
    if (hasValues) reserve(out.values, vertices);
    reserve(out.triangles, triangles);
    reserve(out.objectOfTriangle, triangles);
    if (hasTexcoords) reserve(attributes.texcoords, triangles);
    if (hasColors) reserve(attributes.colors, triangles);
    if (hasNormals) reserve(attributes.normals, triangles);
    if (!materials.empty()) reserve(attributes.material, triangles);
  }

  void appendNodes() {
    constexpr std::size_t kInstancesAtATime = 1024;
    std::size_t done = 0;
    for (const MeshNode& node : meshNodes) {
      const TransientMemory transient(document.file().memory);
      checkpoint(document.file());
      const std::vector<GltfPrimitive>& primitives = *meshes[node.mesh];
      if (!primitives.empty()) {
        for (const Affine& instance : instancesOf(document, document.at("nodes", node.node))) {
          if (++done % kInstancesAtATime == 0) checkpoint(document.file());
          for (const GltfPrimitive& primitive : primitives)
            append(primitive, node.world * instance);
        }
      }
      out.objectOfTriangle.resize(out.triangles.size(),
                                  static_cast<std::uint32_t>(out.objects.size()));
      out.objects.push_back(nameOf(node));
    }
  }

  void warn() {
    const auto add = [&](const std::string& what) {
      out.warnings.push_back(document.file().name + ": " + what);
    };
    if (pointsAndLines > 0) {
      add(std::to_string(pointsAndLines) +
          " of its primitives are points or lines, which are left out");
    }
    const bool skinned = std::any_of(meshNodes.begin(), meshNodes.end(), [&](const MeshNode& node) {
      return document.at("nodes", node.node).contains("skin");
    });
    if (skinned) add("its skins are left out: the mesh is read as it is without its skeleton");
    if (morphed) add("its morph targets are left out: the mesh is read as it is without them");
  }

  RawMesh read() {
    decodeMeshes();
    makeRoom();
    appendNodes();
    applyTextureTransforms(document.file(), out);
    warn();
    out.metersPerUnit = below ? below->metersPerUnit : 1.0;  // as glTF is defined
    out.up = below ? below->up : 'y';
    return std::move(out);
  }
};

}  // namespace

RawMesh readGltf(const MeshFile& file) {
  try {
    const GltfDocument document(file);
    return Reader{.document = document}.read();
  } catch (const Json::exception& e) {  // a number too large, a value of another type
    throw inputError(file, "its JSON cannot be used: " + plainText(e.what()));
  }
}

}  // namespace sherd
