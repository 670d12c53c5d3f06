// Reads OBJ files.
#include "formats/obj/read_obj.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "formats/mesh/beside.h"
#include "formats/mesh/polygon_mesh.h"
#include "formats/obj/mtl.h"
#include "formats/obj/obj_lines.h"
#include "mesh/attributes/colors.h"

namespace sherd {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

// Lines, and corners of a line, between two checks of memory and for cancellation.
constexpr std::size_t kAtATime = 4096;

// Numbers for names, in the order of their first use.
class Names {
 public:
  std::uint32_t numberOf(std::string_view name) {
    const auto known = numbers_.find(name);
    if (known != numbers_.end()) return known->second;
    const auto number = static_cast<std::uint32_t>(list_.size());
    list_.emplace_back(name);
    numbers_.emplace(name, number);
    return number;
  }
  const std::vector<std::string>& list() const { return list_; }

 private:
  std::vector<std::string> list_;
  std::map<std::string, std::uint32_t, std::less<>> numbers_;
};

// Which texture coordinate or normal each corner has.
struct CornerIndices {
  const char* kind;
  std::vector<std::uint32_t> ofCorners{};  // kNone: none; empty until a corner has one
  std::size_t largest = 0;                 // used, from 1

  // Returns the values of all corners; empty if none has one.
  template <class Value>
  std::vector<Value> valuesOf(const MeshFile& file, std::size_t corners,
                              const std::vector<Value>& values) {
    std::vector<Value> out;
    if (ofCorners.empty()) return out;
    ofCorners.resize(corners, kNone);
    charge(file, corners, sizeof(Value));
    out.reserve(corners);
    for (const std::uint32_t i : ofCorners) out.push_back(i == kNone ? Value(0.0f) : values[i]);
    return out;
  }
};

struct Reader {
  const MeshFile& file;
  PolygonMesh mesh{};
  std::vector<glm::vec3> colors{};     // [vertices] or empty
  std::vector<glm::vec3> polypaint{};  // the same, of comments
  std::vector<glm::vec2> texcoords{};
  std::vector<glm::vec3> normals{};
  CornerIndices texcoordIndices{"texture coordinate"}, normalIndices{"normal"};
  std::size_t largestVertex = 0, largestVertexLine = 0;  // used, from 1
  std::vector<std::string> libraries{};
  Names materials{}, objects{}, groups{};
  std::vector<std::uint32_t> groupOfFace{};                       // [faces] or empty
  std::uint32_t material = kNone, object = kNone, group = kNone;  // of the next faces
  GrowingMemory memory{file.memory};

  void addVertex(std::string_view rest, std::size_t line) {
    std::array<double, 6> values{};
    std::size_t count = 0;
    rest = rest.substr(0, rest.find('#'));
    while (count < values.size()) {
      const auto value = parseReal(takeWord(rest));
      if (!value) break;
      values[count++] = *value;
    }
    if (count < 3) throw inputError(file, line, "vertex has less than 3 coordinates");
    const double w = count == 4 && values[3] != 0.0 ? values[3] : 1.0;
    mesh.vertices.emplace_back(values[0] / w, values[1] / w, values[2] / w);
    if (count < 6 && colors.empty()) return;
    colors.resize(mesh.vertices.size(), glm::vec3(1.0f));
    if (count == 6) colors.back() = {values[3], values[4], values[5]};
  }

  // Eight digits for each of the next vertices, in ZBrush's files: a mask, which is left out, and
  // the color.  A line that is not so is a comment.
  void addPolypaint(std::string_view digits) {
    constexpr std::size_t kDigits = 8;
    digits = trimmed(digits);
    const auto channel = [&](std::size_t at) {
      unsigned value = 0;
      std::from_chars(digits.data() + at, digits.data() + at + 2, value, 16);
      return static_cast<float>(value) / 255.0f;
    };
    const auto isDigit = [](unsigned char c) { return std::isxdigit(c) != 0; };
    if (digits.size() % kDigits != 0 || !std::ranges::all_of(digits, isDigit)) return;
    for (std::size_t at = 0; at < digits.size(); at += kDigits) {
      polypaint.emplace_back(channel(at + 2), channel(at + 4), channel(at + 6));
    }
  }

  // A corner "v", "v/vt", "v//vn" or "v/vt/vn"; numbers below 0 count from the end.
  void addCorner(std::string_view word, std::size_t line) {
    std::int64_t vertex = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), vertex);
    const auto length = static_cast<std::size_t>(end - word.data());
    if (error != std::errc() || vertex == 0 || word.back() == '/' ||
        (length < word.size() && word[length] != '/')) {
      throw inputError(file, line,
                       "face has the corner " + inQuotes(word) + ", not a vertex number");
    }
    const auto count = static_cast<std::int64_t>(mesh.vertices.size());
    if (vertex < -count) {
      throw inputError(file, line,
                       "face uses vertex " + std::to_string(vertex) + ", there are " +
                           std::to_string(count) + " before it");
    }
    if (vertex > 0 && static_cast<std::size_t>(vertex) > largestVertex) {
      largestVertex = static_cast<std::size_t>(vertex);
      largestVertexLine = line;
    }
    mesh.corners.push_back(static_cast<std::uint32_t>(vertex < 0 ? count + vertex : vertex - 1));
    std::string_view rest = word.substr(std::min(length + 1, word.size()));
    addIndex(takePart(rest), texcoords.size(), texcoordIndices, word, line);
    addIndex(takePart(rest), normals.size(), normalIndices, word, line);
    if (mesh.corners.size() % kAtATime == 0) hold();
  }

  // Returns the text before the next slash and removes both.
  static std::string_view takePart(std::string_view& rest) {
    const std::string_view part = rest.substr(0, rest.find('/'));
    rest.remove_prefix(std::min(part.size() + 1, rest.size()));
    return part;
  }

  // Sets the texture coordinate or the normal of the last corner.
  //   number  may be empty
  //   count   of those before it
  void addIndex(std::string_view number, std::size_t count, CornerIndices& out,
                std::string_view word, std::size_t line) const {
    if (number.empty()) {
      if (!out.ofCorners.empty()) out.ofCorners.push_back(kNone);
      return;
    }
    const auto index = parseInteger<std::int64_t>(number);
    const auto known = static_cast<std::int64_t>(count);
    if (!index || *index == 0 || *index < -known || *index > std::int64_t{kNone}) {
      throw inputError(
          file, line,
          "face has the corner " + inQuotes(word) + ", whose " + out.kind + " does not exist");
    }
    out.ofCorners.resize(mesh.corners.size(), kNone);
    out.ofCorners.back() = static_cast<std::uint32_t>(*index < 0 ? known + *index : *index - 1);
    out.largest = std::max(out.largest, out.ofCorners.back() + std::size_t{1});
  }

  // Faces are checked at the end: vertices may follow the faces that use them.
  void addFace(std::string_view rest, std::size_t line) {
    const std::size_t first = mesh.corners.size();
    rest = rest.substr(0, rest.find('#'));
    for (std::string_view word = takeWord(rest); !word.empty(); word = takeWord(rest)) {
      addCorner(word, line);
    }
    if (mesh.corners.size() < first + 3)
      throw inputError(file, line, "face has less than 3 corners");
    mesh.faceEnds.push_back(static_cast<std::uint32_t>(mesh.corners.size()));
    setLast(material, mesh.faceMaterials);
    setLast(object, mesh.objectOfFace);
    setLast(group, groupOfFace);
  }

  // Sets the entry of the last face; the array is empty until a face has one.
  void setLast(std::uint32_t of, std::vector<std::uint32_t>& ofFaces) const {
    if (of == kNone && ofFaces.empty()) return;
    ofFaces.resize(mesh.faceEnds.size(), kNone);
    ofFaces.back() = of;
  }

  // Bytes held, with the look-up of names.
  [[nodiscard]] std::uint64_t bytesHeld() const {
    constexpr std::uint64_t kName = 160;
    return mesh.bytes() + (colors.size() + polypaint.size() + normals.size()) * sizeof(glm::vec3) +
           texcoords.size() * sizeof(glm::vec2) +
           (texcoordIndices.ofCorners.size() + normalIndices.ofCorners.size() +
            groupOfFace.size()) *
               sizeof(std::uint32_t) +
           kName * (materials.list().size() + objects.list().size() + groups.list().size() +
                    libraries.size());
  }

  void hold() {
    checkpoint(file);
    memory.hold(bytesHeld());
  }

  void readLines() {
    std::size_t count = 0;
    ObjLines lines(withoutByteOrderMark(file.bytes));
    while (lines.next()) {
      if (++count % kAtATime == 0) hold();
      std::string_view rest = lines.line();
      const std::string_view keyword = takeWord(rest);
      if (keyword == "v") {
        addVertex(rest, lines.number());
      } else if (keyword == "vt") {
        const auto u = parseReal(takeWord(rest)), v = parseReal(takeWord(rest));
        texcoords.emplace_back(u.value_or(0.0), v.value_or(0.0));
      } else if (keyword == "vn") {
        glm::vec3& normal = normals.emplace_back(0.0f);
        for (int k = 0; k < 3; ++k) {
          normal[k] = static_cast<float>(parseReal(takeWord(rest)).value_or(0.0));
        }
      } else if (keyword == "f") {
        addFace(rest, lines.number());
      } else if (keyword == "usemtl") {
        material = materials.numberOf(trimmed(rest));
      } else if (keyword == "mtllib") {
        libraries.emplace_back(trimmed(rest));
      } else if (keyword == "o") {
        object = objects.numberOf(trimmed(rest));
      } else if (keyword == "#MRGB") {
        addPolypaint(rest);
      } else if (keyword == "g") {
        group = groups.numberOf(trimmed(rest));
      }
    }
  }

  void checkIndices() const {
    if (largestVertex > mesh.vertices.size()) {
      throw inputError(file, largestVertexLine,
                       "face uses vertex " + std::to_string(largestVertex) + ", the file has " +
                           std::to_string(mesh.vertices.size()));
    }
    requireAll(texcoordIndices, texcoords.size());
    requireAll(normalIndices, normals.size());
  }

  void requireAll(const CornerIndices& used, std::size_t count) const {
    if (used.largest <= count) return;
    throw inputError(file, std::string("face uses ") + used.kind + " " +
                               std::to_string(used.largest) + ", the file has " +
                               std::to_string(count));
  }

  // Faces before the first name have an empty name.
  static void nameAll(std::vector<std::uint32_t>& ofFaces, Names& names) {
    for (std::uint32_t& of : ofFaces) {
      if (of == kNone) of = names.numberOf("");
    }
  }

  // A line is one file name, possibly with blanks, or several names.
  void readLibraries(RawMesh& out) {
    // A line "newmtl a" makes an entry of the map.
    constexpr std::uint64_t kMostPerByte = 16;
    std::map<std::string, MtlMaterial> known;
    std::set<std::string, std::less<>> read;
    for (const std::string& line : libraries) {
      checkpoint(file);
      const NamedFile whole = fileBeside(file, line);
      std::error_code error;
      const bool isOne =
          whole.refusal.empty() && std::filesystem::is_regular_file(whole.path, error);
      std::string_view rest = line;
      for (std::string_view name = isOne ? rest : takeWord(rest); !name.empty();
           name = isOne ? std::string_view() : takeWord(rest)) {
        if (!read.emplace(name).second) continue;  // a library is read once
        const auto text = readBeside(file, name, "material library", out.warnings);
        if (!text) continue;
        charge(file, text->size(), kMostPerByte);  // before its materials are counted
        addMtl(*text, known);
      }
    }
    addProperties(known, out);
  }

  // Other formats have no tiling beside a texture's name: it is applied to the coordinates of the
  // faces with the material.
  void tile(const std::map<std::string, MtlMaterial>& known, RawMesh& out) {
    std::vector<MtlTiling> tilings;
    bool isAny = false;
    for (const Material& named : out.appearance.materials) {
      const auto found = known.find(named.name);
      tilings.push_back(found == known.end() ? MtlTiling() : found->second.tiling);
      isAny |= tilings.back() != MtlTiling();
      if (found == known.end() || !found->second.hasOtherTilings) continue;
      out.warnings.push_back(file.name + ": the maps of its material " + inQuotes(named.name) +
                             " are tiled in several ways, and all get that of its base color");
    }
    if (!isAny) return;
    std::uint32_t first = 0;
    for (std::size_t f = 0; f < mesh.faceEnds.size(); ++f) {
      const MtlTiling& tiling = tilings[mesh.faceMaterials[f]];
      for (; first < mesh.faceEnds[f]; ++first) {
        glm::vec2& at = mesh.cornerTexcoords[first];
        at = tiling.offset + tiling.scale * at;
      }
    }
  }

  // Textures of base colors precede the others.
  void addProperties(const std::map<std::string, MtlMaterial>& known, RawMesh& out) {
    const bool textured = !mesh.cornerTexcoords.empty();
    const auto textureOf = [&](const std::string& name) {
      return textured ? textureBeside(file, name, out) : -1;
    };
    for (Material& named : out.appearance.materials) {
      const auto found = known.find(named.name);
      if (found == known.end()) continue;
      named.color = found->second.color;
      if (!found->second.texture.empty()) named.texture = textureOf(found->second.texture);
    }
    std::vector<std::string> leftOut;
    const auto isGray = [&](int texture) {
      return isGrayImage(out.appearance.textures[static_cast<std::size_t>(texture)].bytes);
    };
    for (Material& named : out.appearance.materials) {
      const auto found = known.find(named.name);
      if (found == known.end()) continue;
      named.gltf = gltfOf(found->second, named.texture, textureOf, isGray, leftOut);
    }
    if (textured) tile(known, out);
    for (const std::string& name : leftOut) {
      if (!textured) break;
      out.warnings.push_back(file.name + ": its texture " + inQuotes(name) +
                             " is for one property alone, or of heights, which no other format "
                             "has, so it is left out");
    }
  }

  // Vertices have colors and no other attributes.
  void takeChannel(RawMesh& out) const {
    if (file.attribute.empty() || colors.empty()) return;
    out.valueNames = {"red", "green", "blue"};
    const auto found = std::find(out.valueNames.begin(), out.valueNames.end(), file.attribute);
    if (found == out.valueNames.end()) return;
    charge(file, mesh.vertices.size(), sizeof(float));
    const auto channel = static_cast<int>(found - out.valueNames.begin());
    for (const glm::vec3& color : colors) out.values.push_back(color[channel]);
    out.values.resize(mesh.vertices.size(), 1.0f);
  }

  RawMesh read() {
    readLines();
    checkIndices();
    if (colors.empty() && polypaint.size() == mesh.vertices.size()) colors = std::move(polypaint);
    RawMesh out;
    takeChannel(out);
    mesh.vertexColors = colorsFrom(colors);
    mesh.cornerTexcoords = texcoordIndices.valuesOf(file, mesh.corners.size(), texcoords);
    mesh.cornerNormals = normalIndices.valuesOf(file, mesh.corners.size(), normals);
    nameAll(mesh.faceMaterials, materials);
    if (!mesh.faceMaterials.empty()) {
      for (const std::string& name : materials.list())
        out.appearance.materials.push_back({.name = name});
      readLibraries(out);
    }
    if (mesh.objectOfFace.empty()) {
      mesh.objectOfFace = std::move(groupOfFace);
      std::swap(objects, groups);
    }
    nameAll(mesh.objectOfFace, objects);
    out.objects = objects.list();
    triangulateInto(file, std::move(mesh), out);
    return out;
  }
};

}  // namespace

RawMesh readObj(const MeshFile& file) { return Reader{.file = file}.read(); }

}  // namespace sherd
