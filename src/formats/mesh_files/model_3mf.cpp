// Parses a model part of a 3MF file.
#include "formats/mesh_files/model_3mf.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <stdexcept>

#include "base/text/lower_case.h"
#include "base/text/text_scan.h"
#include "formats/mesh_files/xml_tags.h"

namespace sherd {
namespace {

constexpr std::uint64_t kTreeNode = 6 * sizeof(void*);  // of a std::map, besides its value
constexpr std::array<std::string_view, 5> kGroups{"colorgroup", "basematerials", "texture2dgroup",
                                                  "compositematerials", "multiproperties"};

class Parser {
 public:
  Parser(const MeshFile& file, const std::string& name, std::string_view xml)
      : file_(file), name_(name), tags_(withoutByteOrderMark(xml)), memory_(file.memory) {}

  Model3mf read() {
    try {
      for (std::size_t count = 0; tags_.next(tag_); ++count) {
        if (count % kTagsAtATime == 0) checkpoint(file_);
        if (tag_.isEnd) {
          close();
        } else {
          open();
        }
      }
    } catch (const std::runtime_error& e) {
      if (dynamic_cast<const Error*>(&e) != nullptr) throw;
      throw bad(e.what());
    }
    if (!hasEnd_) throw bad("is cut short: it has no end");
    return std::move(model_);
  }

 private:
  [[nodiscard]] Error bad(const std::string& what) const {
    return inputError(file_, "its model '" + plainText(name_.substr(0, 80)) + "' " + what);
  }

  std::uint32_t whole(std::string_view attribute) const {
    const auto value = parseInteger<std::uint32_t>(trimmed(tag_[attribute]));
    if (!value) {
      throw bad("has a " + plainText(tag_.name.substr(0, 40)) + " whose " + std::string(attribute) +
                " is " + inQuotes(tag_[attribute]) + ", a whole number is needed");
    }
    return *value;
  }

  double real(std::string_view attribute) const {
    const auto value = parseReal(trimmed(tag_[attribute]));
    if (!value) {
      throw bad("has a " + plainText(tag_.name.substr(0, 40)) + " whose " + std::string(attribute) +
                " is " + inQuotes(tag_[attribute]) + ", a number is needed");
    }
    return *value;
  }

  // Row vectors: the last three numbers are the offset.
  Transform3mf transform() const {
    Transform3mf out;
    if (!tag_.has("transform")) return out;
    std::string_view rest = tag_["transform"];
    std::array<double, 12> numbers{};
    for (double& number : numbers) {
      const auto value = parseReal(takeWord(rest));
      if (!value) throw bad("has a transform that is not twelve numbers");
      number = *value;
    }
    for (int column = 0; column < 3; ++column) {
      for (int row = 0; row < 3; ++row)
        out.linear[column][row] = numbers[static_cast<std::size_t>(3 * column + row)];
    }
    out.offset = {numbers[9], numbers[10], numbers[11]};
    return out;
  }

  Reference3mf reference() { return {whole("objectid"), path(), transform()}; }

  // Paths are kept once: they may be as long as those of a ZIP file, and as many as components.
  std::uint32_t path() {
    const std::string_view text = tag_.ofAnyPrefix("path");
    if (text.empty()) return Reference3mf::kSameModel;
    const auto [known, isNew] = paths_.try_emplace(decodedPartName3mf(text),
                                                   static_cast<std::uint32_t>(model_.paths.size()));
    if (isNew) {
      charge(file_, 2 * known->first.size() + sizeof(*known) + 3 * sizeof(std::string) +
                        4 * sizeof(void*));
      model_.paths.push_back(known->first);
    }
    return known->second;
  }

  // Objects are shown many times, each with its name.
  std::string decodedName() {
    constexpr std::size_t kLongestEntity = 10;
    const std::string_view text = tag_["name"];
    std::string out = xmlDecoded(text.substr(0, kLongestEntity * (kLongestName3mf + 1)));
    if (out.size() > kLongestName3mf) {
      std::size_t end = kLongestName3mf;
      while (end > 0 && (static_cast<unsigned char>(out[end]) & 0xc0U) == 0x80U) --end;
      out.resize(end);
      out.shrink_to_fit();
      model_.hasCutNames = true;
    }
    return out;
  }

  void open() {
    const std::string_view name = tag_.name;
    if (name == "model") {
      constexpr std::size_t kLongestUnit = 40;  // above that of any unit
      model_.unit = std::string(trimmed(tag_["unit"]).substr(0, kLongestUnit));
      if (tag_.isEmpty) hasEnd_ = true;
    } else if (name == "object") {
      openObject();
    } else if (object_ != nullptr && name == "vertex") {
      object_->vertices.emplace_back(real("x"), real("y"), real("z"));
      hold();
    } else if (object_ != nullptr && name == "triangle") {
      triangle();
    } else if (object_ != nullptr && name == "component") {
      object_->components.push_back(reference());
      hold();
    } else if (name == "beamlattice") {
      model_.hasBeams = true;
    } else if (name == "item") {
      model_.items.push_back(reference());
      hold();
    } else if (std::find(kGroups.begin(), kGroups.end(), name) != kGroups.end()) {
      charge(file_, kTreeNode + sizeof(Group3mf));
      group_ = &model_.groups[whole("id")];
      *group_ = {std::string(name), {}, {}};
      if (tag_.isEmpty) group_ = nullptr;
    } else if (group_ != nullptr && (name == "color" || name == "base")) {
      property();
    }
  }

  void close() {
    if (tag_.name == "model") hasEnd_ = true;
    if (tag_.name == "object") object_ = nullptr;
    if (group_ != nullptr && tag_.name == group_->kind) group_ = nullptr;
  }

  void openObject() {
    charge(file_, kTreeNode + sizeof(Object3mf));
    Object3mf& object = model_.objects[whole("id")];
    if (!object.vertices.empty() || !object.components.empty())
      throw bad("has two objects of the id " + std::string(tag_["id"]));
    object.name = decodedName();
    charge(file_, object.name.capacity());
    own_ = {};
    if (tag_.has("pid")) own_.group = whole("pid");
    if (tag_.has("pindex")) own_.index.fill(whole("pindex"));
    object_ = tag_.isEmpty ? nullptr : &object;
  }

  void triangle() {
    const glm::uvec3 corners(whole("v1"), whole("v2"), whole("v3"));
    for (int k = 0; k < 3; ++k) {
      if (corners[k] < object_->vertices.size()) continue;
      throw bad("has a triangle of vertex " + std::to_string(corners[k]) + ", its object has " +
                std::to_string(object_->vertices.size()));
    }
    Property3mf property = own_;
    if (tag_.has("pid")) property.group = whole("pid");
    if (tag_.has("p1")) property.index.fill(whole("p1"));
    if (tag_.has("p2")) property.index[1] = whole("p2");
    if (tag_.has("p3")) property.index[2] = whole("p3");
    if (property.group != Property3mf::kNone) object_->properties.resize(object_->triangles.size());
    object_->triangles.push_back(corners);
    if (property.group != Property3mf::kNone) object_->properties.push_back(property);
    hold();
  }

  // #RRGGBB or #RRGGBBAA, in sRGB.
  glm::u8vec3 color(std::string_view text) const {
    text = trimmed(text);
    glm::u8vec3 out(0);
    const bool good = (text.size() == 7 || text.size() == 9) && text.front() == '#';
    for (std::size_t k = 0; good && k < 3; ++k) {
      const char* const begin = text.data() + 1 + 2 * k;
      const auto [end, error] = std::from_chars(begin, begin + 2, out[static_cast<int>(k)], 16);
      if (error == std::errc() && end == begin + 2) continue;
      throw bad("has a color " + inQuotes(text) + ", #RRGGBB is needed");
    }
    if (!good) throw bad("has a color " + inQuotes(text) + ", #RRGGBB is needed");
    return out;
  }

  void property() {
    const bool isBase = tag_.name == "base";
    if (group_->kind != (isBase ? "basematerials" : "colorgroup")) return;
    group_->colors.push_back(color(tag_[isBase ? "displaycolor" : "color"]));
    hold();
    if (!isBase) return;
    group_->names.push_back(decodedName());
    charge(file_, group_->names.back().capacity());
  }

  // What one tag adds is less than the most that is charged for it; vectors are copied as they
  // grow.
  void hold() {
    constexpr std::uint64_t kEach = sizeof(glm::uvec3) + sizeof(Property3mf) + sizeof(glm::dvec3);
    constexpr std::uint64_t kReference = sizeof(Reference3mf);
    const bool isLarge = tag_.name == "component" || tag_.name == "item" || tag_.name == "base";
    bytes_ += isLarge ? 2 * kReference : kEach;
    memory_.hold(bytes_);
  }

  const MeshFile& file_;
  const std::string& name_;  // of the part
  XmlTags tags_;
  XmlTag tag_{};
  GrowingMemory memory_;
  std::uint64_t bytes_ = 0;
  Model3mf model_{};
  std::map<std::string, std::uint32_t> paths_{};  // numbers of model_.paths
  Object3mf* object_ = nullptr;                   // that is open
  Property3mf own_{};                             // of its triangles that have none
  Group3mf* group_ = nullptr;                     // that is open
  bool hasEnd_ = false;
};

}  // namespace

std::string partName3mf(std::string_view name) {
  while (name.starts_with('/')) name.remove_prefix(1);
  return lowerCase(std::string(name));
}

std::string decodedPartName3mf(std::string_view attribute) {
  constexpr std::size_t kLongest = 10 * 65536;  // of a ZIP file's names as entities
  return partName3mf(xmlDecoded(attribute.substr(0, kLongest)));
}

Model3mf parsed3mf(const MeshFile& file, const std::string& name, std::string_view xml) {
  return Parser(file, name, xml).read();
}

}  // namespace sherd
