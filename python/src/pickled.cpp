// Solids as pickle keeps them.
#include "pickled.h"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>
#include <sherd/error.h>
#include <sherd/files.h>

#include <cstring>
#include <type_traits>

#include "process.h"

namespace pysherd {

namespace nb = nanobind;

namespace {

using sherd::Material;
using sherd::SourceMesh;
using sherd::Texture;

// Every member of a source that is read from files, in one list for both directions.
template <class Source, class Field>
void eachField(Source& source, Field&& field) {
  field("name", source.name);
  field("stem", source.stem);
  field("sha256", source.sha256);
  field("vertices", source.mesh.vertices);
  field("triangles", source.mesh.triangles);
  field("texcoords", source.mesh.attributes.texcoords);
  field("colors", source.mesh.attributes.colors);
  field("material", source.mesh.attributes.material);
  field("normals", source.mesh.attributes.normals);
  field("materials", source.appearance.materials);
  field("textures", source.appearance.textures);
  field("objects", source.objects);
  field("object_of_triangle", source.objectOfTriangle);
  field("polygons", source.polygons);
  field("grids", source.grids);
  field("warnings", source.warnings);
  field("file_vertices", source.fileVertices);
  field("degenerate_triangles", source.degenerateTriangles);
  field("dropped_vertices", source.droppedVertices);
  field("dropped_triangles", source.droppedTriangles);
  field("isovalue", source.isovalue);
}

// Texts are bytes: names in files need not be UTF-8.
nb::object objectOf(const std::string& text) { return nb::bytes(text.data(), text.size()); }
nb::object objectOf(std::size_t number) { return nb::cast(number); }
nb::object objectOf(const std::optional<double>& number) { return nb::cast(number); }
nb::object objectOf(const Material& material) {
  return nb::make_tuple(objectOf(material.name), material.color.r, material.color.g,
                        material.color.b, material.texture, objectOf(material.gltf));
}
nb::object objectOf(const Texture& texture) {
  return nb::make_tuple(objectOf(texture.name), objectOf(texture.bytes));
}
template <class Item>
nb::object objectOf(const std::vector<Item>& items) {
  if constexpr (std::is_trivially_copyable_v<Item>) {
    return nb::bytes(items.data(), items.size() * sizeof(Item));
  } else {
    nb::list list;
    for (const Item& item : items) list.append(objectOf(item));
    return list;
  }
}

void read(nb::handle object, std::string& text) {
  const auto bytes = nb::cast<nb::bytes>(object);
  text.assign(bytes.c_str(), bytes.size());
}
void read(nb::handle object, std::size_t& number) { number = nb::cast<std::size_t>(object); }
void read(nb::handle object, std::optional<double>& number) {
  number = nb::cast<std::optional<double>>(object);
}
void read(nb::handle object, Material& material) {
  const auto parts = nb::cast<nb::tuple>(object);
  read(parts[0], material.name);
  material.color = {nb::cast<float>(parts[1]), nb::cast<float>(parts[2]),
                    nb::cast<float>(parts[3])};
  material.texture = nb::cast<int>(parts[4]);
  if (parts.size() > 5) read(parts[5], material.gltf);  // not in pickles of 0.1
}
void read(nb::handle object, Texture& texture) {
  const auto parts = nb::cast<nb::tuple>(object);
  read(parts[0], texture.name);
  read(parts[1], texture.bytes);
}
template <class Item>
void read(nb::handle object, std::vector<Item>& items) {
  if constexpr (std::is_trivially_copyable_v<Item>) {
    const auto bytes = nb::cast<nb::bytes>(object);
    items.resize(bytes.size() / sizeof(Item));
    if (!items.empty()) std::memcpy(items.data(), bytes.c_str(), items.size() * sizeof(Item));
  } else {
    for (const nb::handle item : nb::cast<nb::list>(object)) read(item, items.emplace_back());
  }
}

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
  return file.bytes;
}

}  // namespace

nb::dict stateOf(const Solid& solid) {
  nb::dict state;
  state["given"] = solid.given();
  state["own_voxel_size"] = solid.ownVoxelSize();
  const bool hasMesh = !solid.source().mesh.triangles.empty();
  state["level_set"] = objectOf(hasMesh ? std::string() : levelSetOf(solid));
  eachField(solid.source(),
            [&](const char* name, const auto& value) { state[name] = objectOf(value); });
  return state;
}

std::shared_ptr<Object> objectOfState(const nb::dict& state) {
  auto object = std::make_shared<Object>();
  try {
    object->ownVoxelSize = nb::cast<double>(state["own_voxel_size"]);
    read(state["level_set"], object->levelSet);
    eachField(object->source.emplace(),
              [&](const char* name, auto& value) { read(state[name], value); });
  } catch (const std::exception&) {  // another version's
    throw sherd::Error(sherd::ErrorCode::input, "this pickle of a solid cannot be read");
  }
  return object;
}

}  // namespace pysherd
