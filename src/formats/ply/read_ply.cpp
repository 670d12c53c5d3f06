// Reads PLY files.
#include "formats/ply/read_ply.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <optional>
#include <utility>

#include "formats/mesh/beside.h"
#include "formats/mesh/polygon_mesh.h"
#include "formats/ply/ply_body.h"
#include "mesh/attributes/colors.h"

namespace sherd {
namespace {

// How the reader uses a property's value.
enum class Role {
  none,
  x,
  y,
  z,
  nx,
  ny,
  nz,
  red,
  green,
  blue,
  u,
  v,
  corners,
  strip,
  texcoords,
  texture,
  material,
  neighbor
};

Role roleOf(const PlyElement& element, const PlyProperty& property) {
  const auto is = [&](auto... names) { return ((property.name == names) || ...); };
  const bool ofVertex = element.name == "vertex", ofFace = element.name == "face";
  if (property.listCount) {
    if (ofFace && is("texcoord")) return Role::texcoords;
    if (!is("vertex_indices", "vertex_index")) return Role::none;
    if (element.name == "tristrips") return Role::strip;
    return ofFace ? Role::corners : Role::none;
  }
  if (ofVertex && is("x")) return Role::x;
  if (ofVertex && is("y")) return Role::y;
  if (ofVertex && is("z")) return Role::z;
  if (ofVertex && is("nx")) return Role::nx;
  if (ofVertex && is("ny")) return Role::ny;
  if (ofVertex && is("nz")) return Role::nz;
  if (ofVertex && is("u", "s", "texture_u", "texture_s")) return Role::u;
  if (ofVertex && is("v", "t", "texture_v", "texture_t")) return Role::v;
  if ((ofVertex || ofFace) && is("red", "r", "diffuse_red")) return Role::red;
  if ((ofVertex || ofFace) && is("green", "g", "diffuse_green")) return Role::green;
  if ((ofVertex || ofFace) && is("blue", "b", "diffuse_blue")) return Role::blue;
  if (ofFace && is("texnumber")) return Role::texture;
  if (ofFace && is("material")) return Role::material;
  if (ofFace && is("neighbor")) return Role::neighbor;
  return Role::none;
}

// A property of an element, and its role.
struct Column {
  const PlyProperty* property;
  Role role;
  bool isValue = false;  // of MeshFile::attribute
};

std::vector<Column> columnsOf(const PlyElement& element) {
  std::vector<Column> columns;
  for (const PlyProperty& property : element.properties) {
    columns.push_back({&property, roleOf(element, property)});
  }
  return columns;
}

bool hasRoles(const PlyElement* element, std::initializer_list<Role> roles) {
  if (element == nullptr) return false;
  const std::vector<Column> columns = columnsOf(*element);
  return std::all_of(roles.begin(), roles.end(), [&](Role role) {
    return std::any_of(columns.begin(), columns.end(),
                       [&](const Column& column) { return column.role == role; });
  });
}

const PlyElement* find(const PlyHeader& header, const std::string& name) {
  const auto found = std::find_if(header.elements.begin(), header.elements.end(),
                                  [&](const PlyElement& e) { return e.name == name; });
  return found == header.elements.end() ? nullptr : &*found;
}

// Returns how many items of an element a file of that size can hold.
std::size_t mostOf(const PlyElement& element, const MeshFile& file, PlyEncoding encoding) {
  std::size_t least = 0;
  for (const PlyProperty& property : element.properties) {
    const PlyType& first = property.listCount ? *property.listCount : property.value;
    least += encoding == PlyEncoding::ascii ? 2 : first.bytes;
  }
  return std::min(element.count, file.bytes.size() / std::max<std::size_t>(least, 1));
}

// Returns a color channel as a fraction of its type's largest value; floats are unchanged.
float channel(double value, const PlyType& type) {
  if (!type.isInteger) return static_cast<float>(value);
  const double bits = 8.0 * static_cast<double>(type.bytes) - (type.isSigned ? 1.0 : 0.0);
  return static_cast<float>(value / (std::exp2(bits) - 1.0));
}

// The scalar values of one vertex or face.
struct Values {
  glm::dvec3 position{0.0};
  glm::vec3 normal{0.0f};
  glm::vec3 color{1.0f};
  glm::vec2 texcoord{0.0f};
  std::uint32_t texture = 0, material = 0;
  double neighbor = 0.0;
  float value = 0.0f;  // of MeshFile::attribute
};

constexpr std::int64_t kItemsAtATime = 4096;

struct Reader {
  const MeshFile& file;
  PlyHeader header = readPlyHeader(file);
  const PlyElement* vertex = find(header, "vertex");
  const PlyElement* face = find(header, "face");
  const PlyElement* strips = find(header, "tristrips");
  std::size_t vertexCount = vertex == nullptr ? 0 : vertex->count;
  bool vertexColors = hasRoles(vertex, {Role::red, Role::green, Role::blue});
  bool faceColors = !vertexColors && hasRoles(face, {Role::red, Role::green, Role::blue});
  bool cornerTexcoords = hasRoles(face, {Role::texcoords});
  bool vertexTexcoords = !cornerTexcoords && hasRoles(vertex, {Role::u, Role::v});
  bool byMaterial = hasRoles(face, {Role::material});
  bool hasNeighbors = hasRoles(face, {Role::neighbor}) && strips == nullptr;
  // Beside neighbors they are Sherd's, means that include the faces of cracks.
  bool vertexNormals = !hasNeighbors && hasRoles(vertex, {Role::nx, Role::ny, Role::nz});

  RawMesh out{};
  PolygonMesh mesh{};
  std::vector<glm::vec3> colors{};         // of vertices or faces
  std::vector<std::uint32_t> materials{};  // [faces] as in the file
  std::vector<float> texcoords{};          // of one face
  std::vector<std::int64_t> strip{};
  bool hasValues = false;      // of MeshFile::attribute
  std::size_t cornerRoom = 0;  // reserved for mesh.corners at once
  GrowingMemory memory{file.memory};

  void checkHeader() const {
    for (const PlyElement& element : header.elements) {
      if (element.properties.empty() && element.count > 0)
        throw inputError(file, "element " + inQuotes(element.name) + " has no properties");
      for (const PlyProperty& property : element.properties) {
        const Role role = roleOf(element, property);
        if ((role == Role::corners || role == Role::strip) && !property.value.isInteger)
          throw inputError(file, "its faces' corners are not of a whole-number type");
      }
    }
    if (!hasRoles(vertex, {Role::x, Role::y, Role::z}))
      throw inputError(file, "its vertices have no x, y and z");
    const bool someFaces = (face != nullptr && face->count > 0) || strips != nullptr;
    if (!someFaces && vertexCount > 0) {
      throw inputError(
          file, "holds " + std::to_string(vertexCount) + " points and no faces; a mesh is needed");
    }
    if (!hasRoles(face, {Role::corners}) && !hasRoles(strips, {Role::strip}))
      throw inputError(file, "its faces have no list 'vertex_indices'");
  }

  void requireVertex(std::int64_t index, const PlyBody& body) const {
    if (index >= 0 && static_cast<std::size_t>(index) < vertexCount) return;
    throw body.bad("uses vertex " + std::to_string(index) + ", the file has " +
                   std::to_string(vertexCount));
  }

  void takeList(PlyBody& body, const Column& column) {
    const PlyType& type = column.property->value;
    const std::int64_t length = body.integer(*column.property->listCount);
    if (length < 0) throw body.bad("has a list of negative length");
    if (column.role == Role::none) body.skip(type, static_cast<std::size_t>(length));
    if (length > kItemsAtATime) holdList(static_cast<std::size_t>(length));
    if (column.role == Role::strip) strip.clear();
    if (column.role == Role::texcoords) texcoords.clear();
    for (std::int64_t i = 0; i < length && column.role != Role::none; ++i) {
      if ((i + 1) % kItemsAtATime == 0) checkpoint(file);
      if (column.role == Role::texcoords) {
        texcoords.push_back(static_cast<float>(body.number(type)));
        continue;
      }
      const std::int64_t index = body.integer(type);
      const bool endsStrip = column.role == Role::strip && index == -1;
      if (!endsStrip) requireVertex(index, body);
      if (column.role == Role::strip)
        strip.push_back(index);
      else
        mesh.corners.push_back(static_cast<std::uint32_t>(index));
    }
  }

  void takeNumber(PlyBody& body, const Column& column, Values& values) const {
    const PlyType& type = column.property->value;
    if (column.role == Role::none && !column.isValue) return body.skip(type, 1);
    const double value = body.number(type);
    if (column.isValue) values.value = static_cast<float>(value);
    switch (column.role) {
      case Role::x:
      case Role::y:
      case Role::z:
        values.position[static_cast<int>(column.role) - static_cast<int>(Role::x)] = value;
        break;
      case Role::nx:
      case Role::ny:
      case Role::nz:
        values.normal[static_cast<int>(column.role) - static_cast<int>(Role::nx)] =
            static_cast<float>(value);
        break;
      case Role::red:
      case Role::green:
      case Role::blue:
        values.color[static_cast<int>(column.role) - static_cast<int>(Role::red)] =
            channel(value, type);
        break;
      case Role::u:
      case Role::v:
        values.texcoord[column.role == Role::u ? 0 : 1] = static_cast<float>(value);
        break;
      case Role::neighbor:
        values.neighbor = value;
        break;
      default: {
        const bool good = value >= 0.0 && value <= std::numeric_limits<std::int32_t>::max();
        (column.role == Role::texture ? values.texture : values.material) =
            good ? static_cast<std::uint32_t>(value) : 0;
      }
    }
  }

  void addVertex(const Values& values) {
    mesh.vertices.push_back(values.position);
    if (vertexNormals) mesh.vertexNormals.push_back(values.normal);
    if (vertexColors) colors.push_back(values.color);
    if (hasValues) out.values.push_back(values.value);
    if (vertexTexcoords) mesh.vertexTexcoords.push_back(values.texcoord);
  }

  // Its corners are the last of the mesh; with one or two it is a point or a line and is dropped.
  void addFace(const Values& values) {
    const std::size_t first = mesh.faceEnds.empty() ? 0 : mesh.faceEnds.back();
    const std::size_t count = mesh.corners.size() - first;
    if (count < 3) {
      mesh.leaveOutFace();
      return mesh.corners.resize(first);
    }
    mesh.endFace();
    if (faceColors) colors.push_back(values.color);
    materials.push_back(byMaterial ? values.material : values.texture);
    if (hasNeighbors) addNeighbor(values.neighbor);
    for (std::size_t k = 0; k < count && cornerTexcoords; ++k) {
      const bool present = 2 * k + 1 < texcoords.size();
      mesh.cornerTexcoords.push_back(present ? glm::vec2(texcoords[2 * k], texcoords[2 * k + 1])
                                             : glm::vec2(0.0f));
    }
  }

  // A value that is no id shows that the property is not a fragment's: then none is kept.
  void addNeighbor(double value) {
    hasNeighbors = value >= 0.0 && value <= std::numeric_limits<std::uint16_t>::max() &&
                   value == std::floor(value);
    if (hasNeighbors) {
      mesh.faceNeighbors.push_back(static_cast<std::uint16_t>(value));
    } else {
      mesh.faceNeighbors.clear();
    }
  }

  // Strips end at -1; every second triangle of one is flipped.
  void addStrips() {
    texcoords.clear();
    std::size_t begin = 0;
    for (std::size_t i = 0; i < strip.size(); ++i) {
      if (strip[i] == -1) begin = i + 1;
      if (i < begin + 2) continue;
      const bool flipped = (i - begin) % 2 == 1;
      for (const std::size_t k : {i - 2, i - (flipped ? 0 : 1), i - (flipped ? 1 : 0)}) {
        mesh.corners.push_back(static_cast<std::uint32_t>(strip[k]));
      }
      addFace({});
    }
  }

  // Bytes held, without those that were reserved at once.
  [[nodiscard]] std::uint64_t bytesBeyondRoom() const {
    const std::uint64_t reserved =
        mesh.vertices.size() * sizeof(glm::dvec3) +
        std::min(mesh.corners.size(), cornerRoom) * sizeof(std::uint32_t);
    return mesh.bytes() - reserved + colors.size() * sizeof(glm::vec3) +
           materials.size() * sizeof(std::uint32_t) + texcoords.size() * sizeof(float) +
           out.values.size() * sizeof(float) + strip.size() * sizeof(std::int64_t);
  }

  // A list may be as long as the file. An item of it is at most a corner of a strip, and a
  // triangle's three corners, its end and its material.
  void holdList(std::size_t length) {
    constexpr std::uint64_t kMostPerCorner = sizeof(std::int64_t) + 5 * sizeof(std::uint32_t);
    checkpoint(file);
    memory.hold(bytesBeyondRoom() + std::min(length, file.bytes.size()) * kMostPerCorner);
  }

  // Marks the property of the vertices that is wanted, if there is one.
  void findValues(std::vector<Column>& columns) {
    for (Column& column : columns) {
      if (file.attribute.empty() || column.property->listCount) continue;
      column.isValue = column.property->name == file.attribute;
      hasValues = hasValues || column.isValue;
      const bool isPosition =
          column.role == Role::x || column.role == Role::y || column.role == Role::z;
      if (!isPosition) out.valueNames.push_back(column.property->name);
    }
  }

  void readBody() {
    PlyBody body(file, header);
    for (const PlyElement& element : header.elements) {
      std::vector<Column> columns = columnsOf(element);
      const bool isVertex = &element == vertex, isFace = &element == face;
      if (isVertex) findValues(columns);
      // Reserved at once, since doubling takes more; what exceeds it is charged as it grows.
      const std::size_t most = mostOf(element, file, header.encoding);
      if (isVertex) {
        charge(file, most, sizeof(glm::dvec3));
        mesh.vertices.reserve(most);
      }
      if (isFace) {
        charge(file, most, 3 * sizeof(std::uint32_t));
        cornerRoom = 3 * most;
        mesh.corners.reserve(cornerRoom);
      }
      Values values;
      for (std::size_t i = 0; i < element.count; ++i) {
        if (i % kItemsAtATime == 0) {
          checkpoint(file);
          memory.hold(bytesBeyondRoom());
        }
        body.begin(element, i);
        for (const Column& column : columns) {
          if (column.property->listCount)
            takeList(body, column);
          else
            takeNumber(body, column, values);
        }
        body.end();
        if (isVertex) addVertex(values);
        if (isFace) addFace(values);
        if (&element == strips) addStrips();
      }
    }
    body.finish();
  }

  // Reads materials from comments: "material NUMBER NAME [TEXTURE]" as Sherd writes them, else one
  // for each "TextureFile NAME", as MeshLab does; TEXTURE counts these from 0.
  void readComments() {
    std::vector<std::string> textures;
    std::vector<std::optional<std::size_t>> textureOf;  // [materials]
    for (const std::string& comment : header.comments) {
      std::string_view rest = comment;
      const std::string_view word = takeWord(rest);
      if (word == "TextureFile") textures.emplace_back(trimmed(rest));
      if (word != "material" || !byMaterial) continue;
      if (parseInteger<std::size_t>(takeWord(rest)) != out.appearance.materials.size()) continue;
      out.appearance.materials.push_back({.name = std::string(takeWord(rest))});
      textureOf.push_back(parseInteger<std::size_t>(takeWord(rest)));
    }
    byMaterial = !out.appearance.materials.empty();
    if (!cornerTexcoords && !vertexTexcoords) return;
    for (std::size_t i = 0; i < textures.size() && !byMaterial; ++i) {
      out.appearance.materials.push_back(
          {.name = std::filesystem::path(textures[i]).stem().string()});
      textureOf.emplace_back(i);
    }
    for (std::size_t i = 0; i < textureOf.size(); ++i) {
      if (!textureOf[i] || *textureOf[i] >= textures.size()) continue;
      out.appearance.materials[i].texture = textureBeside(file, textures[*textureOf[i]], out);
    }
  }

  RawMesh read() {
    checkHeader();
    readComments();
    readBody();
    (vertexColors ? mesh.vertexColors : mesh.faceColors) = colorsFrom(colors);
    if (!out.appearance.materials.empty()) {
      const auto last = static_cast<std::uint32_t>(out.appearance.materials.size()) - 1;
      for (std::uint32_t& material : materials) material = std::min(material, last);
      mesh.faceMaterials = std::move(materials);
    }
    triangulateInto(file, std::move(mesh), out);
    return std::move(out);
  }
};

}  // namespace

RawMesh readPly(const MeshFile& file) { return Reader{.file = file}.read(); }

}  // namespace sherd
