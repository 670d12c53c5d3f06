// Reads 3MF files.
#include "formats/mesh_files/read_3mf.h"

#include <algorithm>
#include <array>
#include <glm/matrix.hpp>
#include <limits>
#include <map>
#include <memory>
#include <set>
#include <stdexcept>
#include <string_view>
#include <tuple>
#include <utility>

#include "base/text/lower_case.h"
#include "base/text/text_scan.h"
#include "formats/arrays/zip_reader.h"
#include "formats/mesh_files/model_3mf.h"
#include "formats/mesh_files/xml_tags.h"

namespace sherd {
namespace {

constexpr int kDeepest = 64;                   // components within components
constexpr std::size_t kMostShown = 1'000'000;  // objects and components, also empty ones

// Names of parts have no case, and begin with a slash or not.
std::string partName(std::string_view name) {
  while (name.starts_with('/')) name.remove_prefix(1);
  return lowerCase(std::string(name));
}

struct NamedUnit {
  std::string_view name;
  double meters;
};
constexpr NamedUnit kUnits[] = {{"micron", 1e-6}, {"millimeter", 1e-3}, {"centimeter", 1e-2},
                                {"inch", 0.0254}, {"foot", 0.3048},     {"meter", 1.0}};

// The package: its parts by name, models parsed once.
class Package {
 public:
  explicit Package(const MeshFile& file)
      : file_(file), entries_(zipEntries(file.bytes, file.name)) {}

  /// Returns the name of the first model.
  std::string root() const {
    if (const ZipEntry* rels = find("_rels/.rels")) {
      const std::string text = unpacked(*rels);
      XmlTags tags(withoutByteOrderMark(text));
      XmlTag tag;
      try {
        while (tags.next(tag)) {
          const bool isModel = tag["Type"].ends_with("/3dmodel");
          const std::string target = partName(xmlDecoded(tag["Target"]));
          if (tag.name == "Relationship" && isModel && find(target) != nullptr) return target;
        }
      } catch (const std::runtime_error& e) {  // then by its usual name
        if (dynamic_cast<const Error*>(&e) != nullptr) throw;
      }
    }
    std::string found;
    for (const ZipEntry& entry : entries_) {
      const std::string name = partName(entry.name);
      if (!name.ends_with(".model")) continue;
      if (found.empty() || name == "3d/3dmodel.model") found = name;
    }
    if (found.empty()) throw inputError(file_, "has no model: it is no 3MF file");
    return found;
  }

  const Model3mf& model(const std::string& name) {
    const auto known = models_.find(name);
    if (known != models_.end()) return known->second;
    const ZipEntry* entry = find(name);
    if (entry == nullptr) {
      throw inputError(
          file_, "refers to the model '" + plainText(name.substr(0, 80)) + "', which is not in it");
    }
    return models_.emplace(name, parsed3mf(file_, name, unpacked(*entry))).first->second;
  }

 private:
  const ZipEntry* find(const std::string& name) const {
    const auto found = std::find_if(entries_.begin(), entries_.end(), [&](const ZipEntry& entry) {
      return partName(entry.name) == name;
    });
    return found == entries_.end() ? nullptr : &*found;
  }

  std::string unpacked(const ZipEntry& entry) const {
    charge(file_, entry.size);
    std::string text;
    text.reserve(entry.size);
    unpack(entry, file_.name, [&](std::string_view block) {
      checkpoint(file_);
      text += block;
    });
    if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff"))
      throw inputError(file_, "holds text in UTF-16, which is not read; save it as UTF-8");
    return text;
  }

  const MeshFile& file_;
  std::vector<ZipEntry> entries_;
  std::map<std::string, Model3mf> models_;
};

class Reader {
 public:
  explicit Reader(const MeshFile& file) : file_(file), package_(file) {}

  RawMesh read() {
    const std::string root = package_.root();
    const Model3mf& model = package_.model(root);
    for (const NamedUnit& known : kUnits) {
      if (model.unit == known.name) out_.metersPerUnit = known.meters;
    }
    std::vector<Reference3mf> items = model.items;
    if (items.empty()) items = allObjects(model);
    for (const Reference3mf& item : items) show(root, item, {}, 0);
    complete();
    warn();
    return std::move(out_);
  }

 private:
  // Without a build all that is no component is shown.
  static std::vector<Reference3mf> allObjects(const Model3mf& model) {
    std::set<std::uint32_t> within;
    for (const auto& [id, object] : model.objects) {
      for (const Reference3mf& component : object.components) within.insert(component.object);
    }
    std::vector<Reference3mf> all;
    for (const auto& [id, object] : model.objects) {
      if (!within.contains(id)) all.push_back({.object = id});
    }
    return all;
  }

  void show(const std::string& from, const Reference3mf& reference, const Transform3mf& outer,
            int depth) {
    if (depth > kDeepest || ++shown_ > kMostShown) {
      throw inputError(file_, "has objects within objects without an end: object " +
                                  std::to_string(reference.object));
    }
    if (shown_ % 1024 == 0) checkpoint(file_);
    const std::string path = reference.path.empty() ? from : partName(reference.path);
    const Model3mf& model = package_.model(path);
    const auto found = model.objects.find(reference.object);
    if (found == model.objects.end()) {
      throw inputError(file_, "shows object " + std::to_string(reference.object) +
                                  ", which its model '" + plainText(path.substr(0, 80)) +
                                  "' does not have");
    }
    const Transform3mf world = outer * reference.transform;
    hasBeams_ |= model.hasBeams;
    add(path, model, found->second, world);
    for (const Reference3mf& component : found->second.components)
      show(path, component, world, depth + 1);
  }

  void add(const std::string& path, const Model3mf& model, const Object3mf& object,
           const Transform3mf& world) {
    if (object.triangles.empty()) return;
    constexpr std::uint64_t kTriangle = sizeof(glm::uvec3) + 3 * sizeof(glm::u8vec3) + 8;
    charge(file_, object.vertices.size(), sizeof(glm::dvec3));
    charge(file_, object.triangles.size(), kTriangle);
    if (out_.vertices.size() + object.vertices.size() > std::numeric_limits<std::uint32_t>::max())
      throw inputError(file_, "has more vertices than 32 bits can count");
    const auto first = static_cast<std::uint32_t>(out_.vertices.size());
    for (const glm::dvec3& v : object.vertices)
      out_.vertices.push_back(world.linear * v + world.offset);
    const bool isMirrored = glm::determinant(world.linear) < 0.0;
    for (std::size_t t = 0; t < object.triangles.size(); ++t) {
      glm::uvec3 corners = object.triangles[t];
      if (isMirrored) std::swap(corners.y, corners.z);
      out_.triangles.push_back(first + corners);
      if (t < object.properties.size()) addProperty(path, model, object.properties[t], isMirrored);
    }
    out_.objectOfTriangle.resize(out_.triangles.size(),
                                 static_cast<std::uint32_t>(out_.objects.size()));
    out_.objects.push_back(object.name);
  }

  // Adds the property of the last triangle.
  void addProperty(const std::string& path, const Model3mf& model, const Property3mf& property,
                   bool isMirrored) {
    if (property.group == Property3mf::kNone) return;
    const auto found = model.groups.find(property.group);
    if (found == model.groups.end()) {
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
      out_.attributes.colors.resize(out_.triangles.size(), kWhite);
      std::array<glm::u8vec3, 3>& corners = out_.attributes.colors.back();
      for (std::size_t k = 0; k < 3; ++k) corners[k] = group.colors[index[k]];
      if (isMirrored) std::swap(corners[1], corners[2]);
    } else {
      out_.attributes.material.resize(out_.triangles.size(), kNoMaterial);
      out_.attributes.material.back() = materialOf(path, property.group, group, index[0]);
    }
  }

  std::uint32_t materialOf(const std::string& path, std::uint32_t id, const Group3mf& group,
                           std::uint32_t index) {
    const auto [known, isNew] =
        materials_.try_emplace({path, id, index}, out_.appearance.materials.size());
    if (isNew) {
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
    if (hasBeams_) out_.warnings.push_back(file_.name + ": its beam lattices are left out");
  }

  static constexpr std::uint32_t kNoMaterial = 0xffffffff;
  static constexpr std::array<glm::u8vec3, 3> kWhite{glm::u8vec3(255), glm::u8vec3(255),
                                                     glm::u8vec3(255)};

  const MeshFile& file_;
  Package package_;
  RawMesh out_{};
  std::map<std::tuple<std::string, std::uint32_t, std::uint32_t>, std::size_t> materials_{};
  std::map<std::string, std::size_t> lost_{};  // triangles, by kind of their group
  std::size_t absent_ = 0;                     // triangles
  std::size_t shown_ = 0;
  bool hasBeams_ = false;
};

}  // namespace

RawMesh read3mf(const MeshFile& file) { return Reader(file).read(); }

}  // namespace sherd
