// Solids as pickle keeps them.
#include "pickled.h"

#include <sherd/error.h>
#include <sherd/files.h>

#include <cmath>
#include <type_traits>

#include "base/files/byte_source.h"
#include "base/memory.h"
#include "formats/mesh/contradictions.h"
#include "process.h"
#include "sealed.h"

namespace pysherd {

namespace nb = nanobind;

namespace {

using sherd::ByteSource;
using sherd::CoordinateBasis;
using sherd::Material;
using sherd::SourceMesh;
using sherd::Texture;

constexpr std::string_view kKind = "solid";

// Every member of a source that is read from files, in one list for both directions.
template <class Source, class Field>
void eachField(Source& source, Field&& field) {
  field(source.name);
  field(source.stem);
  field(source.sha256);
  field(source.mesh.vertices);
  field(source.mesh.triangles);
  field(source.mesh.neighbor);
  field(source.mesh.attributes.texcoords);
  field(source.mesh.attributes.colors);
  field(source.mesh.attributes.material);
  field(source.mesh.attributes.normals);
  field(source.appearance.materials);
  field(source.appearance.textures);
  field(source.objects);
  field(source.objectOfTriangle);
  field(source.polygons);
  field(source.grids);
  field(source.warnings);
  field(source.fileVertices);
  field(source.degenerateTriangles);
  field(source.droppedVertices);
  field(source.droppedTriangles);
  field(source.isovalue);
  field(source.coordinates.metersPerUnit);
  field(source.coordinates.up);
  field(source.coordinates.unitFrom);
  field(source.coordinates.upFrom);
}

// Puts the fields of a source.  Texts may have any bytes.
struct Put {
  Pieces& pieces;

  void operator()(const std::string& text) const { pieces.put(text); }
  void operator()(const std::size_t& number) const { pieces.putOne(number); }
  void operator()(const double& number) const { pieces.putOne(number); }
  void operator()(const char& axis) const { pieces.putOne(axis); }
  void operator()(const CoordinateBasis& basis) const { pieces.putOne(basis); }
  void operator()(const std::optional<double>& number) const {
    pieces.putSize(number ? 1 : 0);
    if (number) pieces.putOne(*number);
  }
  void operator()(const Material& material) const {
    pieces.put(material.name);
    pieces.putOne(material.color);
    pieces.putOne(material.texture);
    pieces.put(material.gltf);
  }
  void operator()(const Texture& texture) const {
    pieces.put(texture.name);
    pieces.put(texture.bytes);
  }
  void operator()(const std::pair<std::string, std::string>& option) const {
    pieces.put(option.first);
    pieces.put(option.second);
  }
  template <class Item>
  void operator()(const std::vector<Item>& items) const {
    if constexpr (std::is_trivially_copyable_v<Item>) {
      pieces.put(items);
    } else {
      pieces.putSize(items.size());
      for (const Item& item : items) (*this)(item);
    }
  }
};

// Reads them.
struct Take {
  ByteSource& source;

  void operator()(std::string& text) const { source.take(text); }
  void operator()(std::size_t& number) const { source.takeOne(number); }
  void operator()(double& number) const { source.takeOne(number); }
  void operator()(char& axis) const { source.takeOne(axis); }
  void operator()(CoordinateBasis& basis) const { source.takeOne(basis); }
  void operator()(std::optional<double>& number) const {
    std::vector<char> some;
    source.makeRoom(some, ByteSource::kCountBytes + sizeof(double));
    if (!some.empty()) source.takeOne(number.emplace());
  }
  void operator()(Material& material) const {
    source.take(material.name);
    source.takeOne(material.color);
    source.takeOne(material.texture);
    source.take(material.gltf);
  }
  void operator()(Texture& texture) const {
    source.take(texture.name);
    source.take(texture.bytes);
  }
  void operator()(std::pair<std::string, std::string>& option) const {
    source.take(option.first);
    source.take(option.second);
  }
  template <class Item>
  void operator()(std::vector<Item>& items) const {
    if constexpr (std::is_trivially_copyable_v<Item>) {
      source.take(items);
    } else {
      source.makeRoom(items, ByteSource::kCountBytes);
      for (Item& item : items) (*this)(item);
    }
  }
};

/// Keeps one file in memory.
struct InMemory : sherd::FileSink {
  std::string bytes;
  void take(const std::string&, const sherd::Content& content) override {
    content([this](std::string_view more) { bytes += more; });
  }
};

std::string levelSetOf(const Solid& solid) {
  InMemory file;
  const auto write = [&] {
    sherd::writeVdbOfSolid(sherd::OutputFile(file, "solid.vdb"), solid.solid(), {});
  };
  requireUsableProcess();
  onWorker(write);
  return std::move(file.bytes);
}

bool isName(const std::string& text) {
  return text.find('/') == std::string::npos && text.find('\0') == std::string::npos;
}

bool isPossible(const sherd::CoordinateSystem& coordinates) {
  const auto isBasis = [](CoordinateBasis basis) {
    return basis >= CoordinateBasis::format && basis <= CoordinateBasis::option;
  };
  return std::isfinite(coordinates.metersPerUnit) && coordinates.metersPerUnit > 0.0 &&
         coordinates.up >= 'x' && coordinates.up <= 'z' && isBasis(coordinates.unitFrom) &&
         isBasis(coordinates.upFrom);
}

// Returns what is wrong with an object beyond its checksum, as a clause; empty if nothing is.
std::string faultOf(const Object& object) {
  const SourceMesh& source = *object.source;
  const bool hasMesh = !source.mesh.triangles.empty();
  if (hasMesh == !object.levelSet.empty()) {
    return hasMesh ? "has both a mesh and a level set" : "has neither a mesh nor a level set";
  }
  if (!(object.ownVoxelSize >= 0.0 && std::isfinite(object.ownVoxelSize))) {
    return "has voxels whose size is no length";
  }
  if (object.offset && !std::isfinite(object.offset->x + object.offset->y + object.offset->z)) {
    return "has an offset that is not finite";
  }
  if (source.isovalue && !std::isfinite(*source.isovalue)) {
    return "has an isovalue that is not finite";
  }
  if (!isPossible(source.coordinates)) return "has coordinates without a unit or an upward axis";
  if (!isName(source.name) || !isName(source.stem)) return "has a name that is none of a file";
  const auto contradiction = contradictionIn(source);
  return contradiction ? "contradicts itself: " + *contradiction : std::string();
}

}  // namespace

nb::bytes stateOf(const Solid& solid) {
  const bool hasMesh = !solid.source().mesh.triangles.empty();
  const std::string levelSet = hasMesh ? std::string() : levelSetOf(solid);
  const double ownVoxelSize = solid.ownVoxelSize();
  Pieces pieces;
  const Put put{pieces};
  put(solid.given());
  pieces.putOne(ownVoxelSize);
  put(levelSet);
  std::vector<glm::dvec3> offset;  // one or none
  if (solid.offset()) offset.push_back(*solid.offset());
  put(offset);
  eachField(solid.source(), put);
  return sealed(kKind, pieces.all());
}

std::pair<std::shared_ptr<Object>, GivenOptions> objectOfState(nb::handle state) {
  sherd::MemoryBudget memory("this pickle of a solid", sherd::freeMemory());
  ByteSource source(contentOf(kKind, state), &memory);
  const Take take{source};
  auto object = std::make_shared<Object>();
  GivenOptions given;
  take(given);
  source.takeOne(object->ownVoxelSize);
  take(object->levelSet);
  std::vector<glm::dvec3> offset;
  take(offset);
  if (!offset.empty()) object->offset = offset.front();
  eachField(object->source.emplace(), take);
  const std::string fault = offset.size() > 1 ? "has several offsets"
                            : source.isAt({}) ? faultOf(*object)
                                              : "is damaged: its arrays do not fill its state";
  if (!fault.empty()) {
    throw sherd::Error(sherd::ErrorCode::input, "this pickle of a solid " + fault);
  }
  return {std::move(object), std::move(given)};
}

}  // namespace pysherd
