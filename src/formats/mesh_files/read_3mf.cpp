// Reads 3MF files.
#include "formats/mesh_files/read_3mf.h"

#include <algorithm>
#include <array>
#include <glm/matrix.hpp>
#include <limits>
#include <map>
#include <set>
#include <string_view>
#include <tuple>
#include <utility>

#include "base/text/text_scan.h"
#include "formats/mesh_files/model_3mf.h"
#include "formats/mesh_files/package_3mf.h"

namespace sherd {
namespace {

constexpr int kDeepest = 64;                   // components within components
constexpr std::size_t kMostShown = 1'000'000;  // objects and components, also empty ones

struct NamedUnit {
  std::string_view name;
  double meters;
};
constexpr NamedUnit kUnits[] = {{"micron", 1e-6}, {"millimeter", 1e-3}, {"centimeter", 1e-2},
                                {"inch", 0.0254}, {"foot", 0.3048},     {"meter", 1.0}};

// An object where it is shown.
struct Shown {
  const Part3mf* part;
  const Object3mf* object;
  Transform3mf world;
};

class Reader {
 public:
  explicit Reader(const MeshFile& file)
      : file_(file), package_(file), shownMemory_(file.memory), materialMemory_(file.memory) {}

  RawMesh read() {
    const Part3mf& root = package_.root();
    for (const NamedUnit& known : kUnits) {
      if (root.model.unit == known.name) out_.metersPerUnit = known.meters;
    }
    if (root.model.items.empty()) {
      for (const Reference3mf& item : allObjects(root.model)) show(root, item, {}, 0);
    } else {
      for (const Reference3mf& item : root.model.items) show(root, item, {}, 0);
    }
    makeRoom();
    for (const Shown& shown : shown_) add(shown);
    complete();
    warn();
    return std::move(out_);
  }

 private:
  // Without a build all that is no component is shown.
  std::vector<Reference3mf> allObjects(const Model3mf& model) const {
    std::set<std::uint32_t> within;
    for (const auto& [id, object] : model.objects) {
      for (const Reference3mf& component : object.components) within.insert(component.object);
    }
    charge(file_, model.objects.size(), sizeof(Reference3mf));
    std::vector<Reference3mf> all;
    all.reserve(model.objects.size());
    for (const auto& [id, object] : model.objects) {
      if (!within.contains(id)) all.push_back({.object = id});
    }
    return all;
  }

  // Lists what is shown, and charges it.
  void show(const Part3mf& from, const Reference3mf& reference, const Transform3mf& outer,
            int depth) {
    if (depth > kDeepest || ++references_ > kMostShown) {
      throw inputError(file_, "has objects within objects without an end: object " +
                                  std::to_string(reference.object));
    }
    if (references_ % 1024 == 0) checkpoint(file_);
    const Part3mf& part = package_.partOf(from, reference);
    const Model3mf& model = part.model;
    const auto found = model.objects.find(reference.object);
    if (found == model.objects.end()) {
      throw inputError(file_, "shows object " + std::to_string(reference.object) +
                                  ", which its model '" + plainText(part.name.substr(0, 80)) +
                                  "' does not have");
    }
    const Object3mf& object = found->second;
    const Transform3mf world = outer * reference.transform;
    hasBeams_ |= model.hasBeams;
    hasCutNames_ |= model.hasCutNames;
    if (!object.triangles.empty()) {
      constexpr std::uint64_t kTriangle = sizeof(glm::uvec3) + 3 * sizeof(glm::u8vec3) + 8;
      charge(file_, object.vertices.size(), sizeof(glm::dvec3));
      charge(file_, object.triangles.size(), kTriangle);
      charge(file_, sizeof(std::string) + object.name.size());
      shownMemory_.hold((shown_.size() + 1) * sizeof(Shown));
      shown_.push_back({&part, &object, world});
    }
    for (const Reference3mf& component : object.components) show(part, component, world, depth + 1);
  }

  // Arrays that grew would take up to three times what is charged.
  void makeRoom() {
    std::size_t vertices = 0, triangles = 0;
    for (const Shown& shown : shown_) {
      vertices += shown.object->vertices.size();
      triangles += shown.object->triangles.size();
    }
    if (vertices > std::numeric_limits<std::uint32_t>::max())
      throw inputError(file_, "has more vertices than 32 bits can count");
    out_.vertices.reserve(vertices);
    out_.triangles.reserve(triangles);
    out_.objectOfTriangle.reserve(triangles);
    out_.objects.reserve(shown_.size());
  }

  void add(const Shown& shown) {
    const Object3mf& object = *shown.object;
    const Transform3mf& world = shown.world;
    const auto first = static_cast<std::uint32_t>(out_.vertices.size());
    for (const glm::dvec3& v : object.vertices)
      out_.vertices.push_back(world.linear * v + world.offset);
    const bool isMirrored = glm::determinant(world.linear) < 0.0;
    for (std::size_t t = 0; t < object.triangles.size(); ++t) {
      glm::uvec3 corners = object.triangles[t];
      if (isMirrored) std::swap(corners.y, corners.z);
      out_.triangles.push_back(first + corners);
      if (t < object.properties.size()) addProperty(*shown.part, object.properties[t], isMirrored);
    }
    out_.objectOfTriangle.resize(out_.triangles.size(),
                                 static_cast<std::uint32_t>(out_.objects.size()));
    out_.objects.push_back(object.name);
  }

  // Adds the property of the last triangle.
  void addProperty(const Part3mf& part, const Property3mf& property, bool isMirrored) {
    if (property.group == Property3mf::kNone) return;
    const auto found = part.model.groups.find(property.group);
    if (found == part.model.groups.end()) {
      ++absent_;
      return;
    }
    const Group3mf& group = found->second;
    const bool isColor = group.kind == "colorgroup";
    if (!isColor && group.kind != "basematerials") {
      ++lost_[group.kind];
      return;
    }
    const auto& index = property.index;
    const bool isIn =
        index[0] < group.colors.size() &&
        (!isColor || (index[1] < group.colors.size() && index[2] < group.colors.size()));
    if (!isIn) {
      ++absent_;
      return;
    }
    if (isColor) {
      out_.attributes.colors.reserve(out_.triangles.capacity());
      out_.attributes.colors.resize(out_.triangles.size(), kWhite);
      std::array<glm::u8vec3, 3>& corners = out_.attributes.colors.back();
      for (std::size_t k = 0; k < 3; ++k) corners[k] = group.colors[index[k]];
      if (isMirrored) std::swap(corners[1], corners[2]);
    } else {
      out_.attributes.material.reserve(out_.triangles.capacity());
      out_.attributes.material.resize(out_.triangles.size(), kNoMaterial);
      out_.attributes.material.back() = materialOf(part, property.group, group, index[0]);
    }
  }

  std::uint32_t materialOf(const Part3mf& part, std::uint32_t id, const Group3mf& group,
                           std::uint32_t index) {
    const auto [known, isNew] =
        materials_.try_emplace({part.number, id, index}, out_.appearance.materials.size());
    if (isNew) {
      constexpr std::uint64_t kEach = sizeof(Material) + sizeof(*known) + 4 * sizeof(void*);
      materialBytes_ += kEach + group.names[index].size();
      materialMemory_.hold(materialBytes_);
      out_.appearance.materials.push_back(
          {.name = group.names[index], .color = linearFromSrgb(group.colors[index])});
    }
    return static_cast<std::uint32_t>(known->second);
  }

  // Triangles without a color are white, those without a material have one without a name.
  void complete() {
    const std::size_t count = out_.triangles.size();
    SurfaceAttributes& attributes = out_.attributes;
    if (!attributes.colors.empty()) attributes.colors.resize(count, kWhite);
    if (attributes.material.empty()) return;
    attributes.material.resize(count, kNoMaterial);
    const auto none = static_cast<std::uint32_t>(out_.appearance.materials.size());
    const bool isAny = std::find(attributes.material.begin(), attributes.material.end(),
                                 kNoMaterial) != attributes.material.end();
    if (!isAny) return;
    out_.appearance.materials.emplace_back();
    std::replace(attributes.material.begin(), attributes.material.end(), kNoMaterial, none);
  }

  void warn() {
    const auto triangles = [](std::size_t count) {
      return count == 1 ? std::string("1 triangle") : std::to_string(count) + " triangles";
    };
    const std::map<std::string, std::string> kinds{{"texture2dgroup", "textures"},
                                                   {"compositematerials", "mixtures of materials"},
                                                   {"multiproperties", "layers of properties"}};
    for (const auto& [kind, count] : lost_) {
      out_.warnings.push_back(file_.name + ": the " + kinds.at(kind) + " (" + kind + ") of " +
                              triangles(count) + " are left out");
    }
    if (absent_ > 0) {
      out_.warnings.push_back(file_.name + ": the colors or materials of " + triangles(absent_) +
                              " are left out: the file does not have them");
    }
    if (hasCutNames_) {
      out_.warnings.push_back(file_.name + ": names of more than " +
                              std::to_string(kLongestName3mf) + " bytes are cut to that");
    }
    if (hasBeams_) out_.warnings.push_back(file_.name + ": its beam lattices are left out");
  }

  static constexpr std::uint32_t kNoMaterial = 0xffffffff;
  static constexpr std::array<glm::u8vec3, 3> kWhite{glm::u8vec3(255), glm::u8vec3(255),
                                                     glm::u8vec3(255)};

  const MeshFile& file_;
  Package3mf package_;
  RawMesh out_{};
  std::vector<Shown> shown_{};  // with triangles
  GrowingMemory shownMemory_;
  // By the number of their part, group and index.
  std::map<std::tuple<std::size_t, std::uint32_t, std::uint32_t>, std::size_t> materials_{};
  GrowingMemory materialMemory_;
  std::uint64_t materialBytes_ = 0;
  std::map<std::string, std::size_t> lost_{};  // triangles, by kind of their group
  std::size_t absent_ = 0;                     // triangles
  std::size_t references_ = 0;                 // that were followed
  bool hasBeams_ = false;
  bool hasCutNames_ = false;
};

}  // namespace

RawMesh read3mf(const MeshFile& file) { return Reader(file).read(); }

}  // namespace sherd
