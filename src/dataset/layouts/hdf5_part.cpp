// The arrays of a fracture in the layout hdf5.
#include "dataset/layouts/hdf5_part.h"

#include <sherd/error.h>

#include <algorithm>
#include <array>
#include <numeric>

#include "base/files/below_folder.h"
#include "base/files/parsed_json.h"
#include "base/little_endian.h"
#include "dataset/journal/json_fields.h"

namespace sherd {
namespace {

Hdf5Array verticesOf(const TriangleMesh& mesh) {
  std::string bytes(mesh.vertices.size() * 12, '\0');
  char* at = bytes.data();
  for (const glm::dvec3& v : mesh.vertices) {
    for (int axis = 0; axis < 3; ++axis, at += 4) keepLittle(at, static_cast<float>(v[axis]));
  }
  return packedHdf5(Hdf5Type::float32, {mesh.vertices.size(), 3}, bytes);
}

Hdf5Array facesOf(const TriangleMesh& mesh) {
  std::string bytes(mesh.triangles.size() * 12, '\0');
  char* at = bytes.data();
  for (const auto& triangle : mesh.triangles) {
    for (int corner = 0; corner < 3; ++corner, at += 4) {
      keepLittle(at, static_cast<std::uint32_t>(triangle[corner]));
    }
  }
  return packedHdf5(Hdf5Type::int32, {mesh.triangles.size(), 3}, bytes);
}

Hdf5Array sharedFacesOf(const TriangleMesh& mesh, std::size_t fragments) {
  std::string bytes(mesh.triangles.size() * 2, '\0');
  char* at = bytes.data();
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i, at += 2) {
    const std::size_t neighbor = mesh.neighbor.empty() ? 0 : mesh.neighbor[i];
    const std::size_t index = std::min(neighbor - 1, fragments);
    keepLittle(at, static_cast<std::uint16_t>(neighbor == 0 ? 0xffff : index));
  }
  return packedHdf5(Hdf5Type::int16, {mesh.triangles.size()}, bytes);
}

using Touching = std::vector<std::vector<std::size_t>>;  // [fragments] indices

Touching touchingOf(std::span<const Fragment> fragments) {
  Touching touching(fragments.size());
  for (std::size_t i = 0; i < fragments.size(); ++i) {
    for (const Contact& contact : fragments[i].contacts) {
      const auto other = static_cast<std::size_t>(contact.fragment) - 1;
      if (contact.fragment > 0 && other < fragments.size()) touching[i].push_back(other);
    }
  }
  return touching;
}

// The number of connected parts of the fragments that are left.
std::size_t partsOf(const Touching& touching, const std::vector<char>& left) {
  std::vector<char> seen(left.size(), 0);
  std::vector<std::size_t> open;
  std::size_t parts = 0;
  for (std::size_t i = 0; i < left.size(); ++i) {
    if (!left[i] || seen[i]) continue;
    ++parts;
    seen[i] = 1;
    for (open.assign(1, i); !open.empty();) {
      const std::size_t at = open.back();
      open.pop_back();
      for (const std::size_t next : touching[at]) {
        if (left[next] && !std::exchange(seen[next], 1)) open.push_back(next);
      }
    }
  }
  return parts;
}

void addRemovals(std::span<const Fragment> fragments, Hdf5Arrays& arrays) {
  const Touching touching = touchingOf(fragments);
  std::vector<std::size_t> order(fragments.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return fragments[a].mass.volume > fragments[b].mass.volume;
  });
  std::rotate(order.begin(), order.begin() + 1, order.end());
  const std::size_t count = std::min(fragments.size() - 1, kMostRemovals);
  std::vector<char> left(fragments.size(), 1);
  std::string masks, removed;
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t before = partsOf(touching, left);
    // A graph has at least two vertices without which it stays connected: one is found.
    for (const std::size_t i : order) {
      if (!left[i]) continue;
      left[i] = 0;
      if (partsOf(touching, left) <= before) {
        storeLittle(removed, static_cast<std::uint64_t>(i));
        break;
      }
      left[i] = 1;
    }
    masks.append(left.begin(), left.end());
  }
  arrays.emplace_back("removal_masks",
                      packedHdf5(Hdf5Type::boolean, {count, fragments.size()}, masks));
  arrays.emplace_back("removal_order", packedHdf5(Hdf5Type::int64, {count}, removed));
}

}  // namespace

std::string hdf5Key(std::size_t fragment, std::size_t fragments) {
  const std::size_t digits = std::max<std::size_t>(2, std::to_string(fragments - 1).size());
  const std::string number = std::to_string(fragment);
  return std::string(digits - number.size(), '0') + number;
}

std::vector<std::string> hdf5Paths(std::size_t fragments) {
  std::vector<std::string> paths;
  for (std::size_t i = 0; i < fragments; ++i) {
    const std::string group = "pieces/" + hdf5Key(i, fragments) + "/";
    for (const char* array : {"vertices", "faces", "shared_faces"}) paths.push_back(group + array);
  }
  for (const char* array : {"pieces_names", "removal_masks", "removal_order"}) {
    paths.emplace_back(array);
  }
  return paths;
}

Hdf5Arrays hdf5Arrays(const FractureResult& result, bool removal) {
  const std::size_t count = result.kept();
  Hdf5Arrays arrays;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < count; ++i) {
    const TriangleMesh& mesh = result.fragments[i].mesh;
    const std::string key = hdf5Key(i, count), group = "pieces/" + key + "/";
    arrays.emplace_back(group + "vertices", verticesOf(mesh));
    arrays.emplace_back(group + "faces", facesOf(mesh));
    arrays.emplace_back(group + "shared_faces", sharedFacesOf(mesh, count));
    names.push_back("piece_" + key);
  }
  arrays.emplace_back("pieces_names", packedHdf5(names));
  if (removal) addRemovals(std::span(result.fragments).first(count), arrays);
  return arrays;
}

Hdf5Arrays hdf5WholeArrays(const FractureResult& result) {
  const TriangleMesh& mesh = result.fragments.front().mesh;
  return {{"vertices", verticesOf(mesh)}, {"faces", facesOf(mesh)}};
}

// ---- Files of parts: a line of JSON, then the packed arrays one after another

namespace {

constexpr const char* kPartSchema = "sherd-hdf5-part/1";
constexpr const char* kTypes[] = {"float32", "int32", "int16", "int64", "boolean", "text"};

Hdf5Type typeFrom(const std::string& name) {
  const auto* const found = std::find(std::begin(kTypes), std::end(kTypes), name);
  if (found == std::end(kTypes)) fields::damaged("has an array of an unknown type");
  return static_cast<Hdf5Type>(found - std::begin(kTypes));
}

// An array without its packed bytes, and their number.
std::pair<Hdf5Array, std::size_t> arrayFrom(const Json& json) {
  constexpr std::uint64_t kMost = std::uint64_t{1} << 32;
  if (!json.is_object()) fields::damaged("has an array that is not an object");
  Hdf5Array array{
      typeFrom(fields::text(json, "type")), fields::count(json, "item", 1, kMost), {}, {}};
  for (const Json& length : fields::list(json, "shape")) {
    if (!length.is_number_unsigned() || length > kMost) fields::damaged("has a wrong shape");
    array.shape.push_back(length);
  }
  if (array.shape.empty() || array.shape.size() > kMostHdf5Axes)
    fields::damaged("has a wrong shape");
  return {std::move(array), fields::count(json, "bytes", 0, kMost)};
}

}  // namespace

void writeHdf5Part(const OutputFile& file, const Hdf5Arrays& arrays) {
  Json list = Json::array();
  for (const auto& [path, array] : arrays) {
    list.push_back({{"path", path},
                    {"type", kTypes[static_cast<std::size_t>(array.type)]},
                    {"item", array.itemBytes},
                    {"shape", array.shape},
                    {"bytes", array.packed.size()}});
  }
  const Json head = {{"schema", kPartSchema}, {"arrays", std::move(list)}};
  file.write([&](const ByteSink& sink) {
    sink(head.dump() + "\n");
    for (const auto& [path, array] : arrays) sink(array.packed);
  });
}

Hdf5Arrays parsedHdf5Part(std::string_view bytes) {
  const std::size_t end = bytes.find('\n');
  if (end == std::string_view::npos) fields::damaged("is cut");
  const Json head = parsedOrderedJson(bytes.substr(0, end));
  bytes.remove_prefix(end + 1);
  if (!head.is_object() || fields::text(head, "schema") != kPartSchema)
    fields::damaged("is not a part of an HDF5 file");
  Hdf5Arrays arrays;
  for (const Json& json : fields::list(head, "arrays")) {
    auto [array, size] = arrayFrom(json);
    std::string path = fields::text(json, "path");
    if (!isBelowFolder(path)) fields::damaged("has the path '" + path + "'");
    if (size > bytes.size()) fields::damaged("is cut");
    array.packed = bytes.substr(0, size);
    bytes.remove_prefix(size);
    arrays.emplace_back(std::move(path), std::move(array));
  }
  if (!bytes.empty()) fields::damaged("has more bytes than arrays");
  return arrays;
}

}  // namespace sherd
