// Meshes that a glTF file holds compressed by Draco.  Only this file includes Draco.
#include "formats/gltf/gltf_draco.h"

#include <draco/compression/mesh/mesh_edgebreaker_decoder.h>
#include <draco/compression/mesh/mesh_sequential_decoder.h>

#include <memory>
#include <new>
#include <stdexcept>
#include <utility>

#include "base/text/text_scan.h"

namespace sherd {
namespace {

using Json = GltfDocument::Json;

// Draco allocates as many faces and points as a stream announces before it decodes them. A triangle
// of a very regular mesh takes a few hundredths of a byte.
constexpr std::uint64_t kMostPerByte = 256;

// Upper estimates of memory for a face, with its triangle here, for a point, and for a number of a
// point's attributes.
constexpr std::uint64_t kBytesPerFace = 200, kBytesPerPoint = 100, kBytesPerNumber = 24;

// Reads a varint: groups of seven bits, the lowest first.
std::optional<std::uint64_t> takeVarint(std::string_view& bytes) {
  std::uint64_t value = 0;
  for (unsigned shift = 0; shift < 63 && !bytes.empty(); shift += 7) {
    const auto byte = static_cast<unsigned char>(bytes.front());
    bytes.remove_prefix(1);
    value |= std::uint64_t{byte & 0x7fu} << shift;
    if ((byte & 0x80u) == 0) return value;
  }
  return std::nullopt;
}

// The content of a stream's header.
struct Announced {
  bool edgebreaker = false;
  std::uint64_t faces = 0, points = 0;
};

// Returns the header of a mesh in the version that glTF uses, if its counts fit its size.
//
// source  Draco 3D Data Compression, bitstream 2.2, "Header" and "Connectivity"
std::optional<Announced> headerOf(std::string_view stream) {
  constexpr std::size_t kHeader = 11;
  constexpr char kMesh = 1, kSequential = 0, kEdgebreaker = 1;
  const std::uint64_t most = kMostPerByte * stream.size();
  if (stream.size() < kHeader || !stream.starts_with("DRACO\2\2")) return std::nullopt;
  const char type = stream[7], method = stream[8];
  const bool hasMetadata = (static_cast<unsigned char>(stream[10]) & 0x80u) != 0;
  if (type != kMesh || hasMetadata || (method != kSequential && method != kEdgebreaker))
    return std::nullopt;
  const bool edgebreaker = method == kEdgebreaker;
  stream.remove_prefix(kHeader);
  if (edgebreaker) {
    if (stream.empty()) return std::nullopt;
    stream.remove_prefix(1);  // the kind of traversal
  }
  const auto first = takeVarint(stream), second = takeVarint(stream);
  if (!first || !second || *first > most || *second > most) return std::nullopt;
  if (edgebreaker) return Announced{true, *second, *first};
  return Announced{false, *first, *second};
}

// Draco's decoder, which charges the memory of attributes before it allocates them.
template <class Decoder>
class Charged final : public Decoder {
 public:
  explicit Charged(const MeshFile& file) : file_(file) {}

 private:
  bool DecodeAllAttributes() override {
    const draco::PointCloud& points = *this->point_cloud();
    for (int i = 0; i < points.num_attributes(); ++i) {
      const auto numbers = static_cast<std::uint64_t>(points.attribute(i)->num_components());
      charge(file_, points.num_points(), numbers * kBytesPerNumber);
    }
    checkpoint(file_);
    return Decoder::DecodeAllAttributes();
  }

  const MeshFile& file_;
};

template <class Decoder>
std::unique_ptr<draco::Mesh> decodeBy(std::string_view stream, const MeshFile& file) {
  draco::DecoderBuffer buffer;
  buffer.Init(stream.data(), stream.size());
  const draco::DecoderOptions options;
  auto mesh = std::make_unique<draco::Mesh>();
  if (!Charged<Decoder>(file).Decode(options, &buffer, mesh.get()).ok()) return nullptr;
  return mesh;
}

std::unique_ptr<draco::Mesh> decode(std::string_view stream, const MeshFile& file) {
  const std::optional<Announced> header = headerOf(stream);
  if (!header) return nullptr;
  charge(file, header->faces, kBytesPerFace);
  charge(file, header->points, kBytesPerPoint);
  try {
    return header->edgebreaker ? decodeBy<draco::MeshEdgebreakerDecoder>(stream, file)
                               : decodeBy<draco::MeshSequentialDecoder>(stream, file);
  } catch (const std::bad_alloc&) {
    return nullptr;
  } catch (const std::length_error&) {
    return nullptr;
  }
}

// Returns the values of an attribute per point, normalized if the accessor says so.
GltfArray dracoValues(const GltfDocument& document, const draco::Mesh& mesh,
                      const draco::PointAttribute& attribute, const Json& accessor) {
  constexpr int kMostComponents = 16;
  if (attribute.num_components() > kMostComponents)
    throw document.bad("an attribute of a mesh packed by Draco has " +
                       std::to_string(attribute.num_components()) + " numbers for each point");
  // glTF has no such type, and Draco accepts any byte as a bool.
  if (attribute.data_type() == draco::DT_BOOL)
    throw document.bad("an attribute of a mesh packed by Draco holds truth values, not numbers");
  GltfArray out{mesh.num_points(), static_cast<std::size_t>(attribute.num_components()), {}};
  const bool normalize = accessor.value("normalized", Json()) == true && !attribute.normalized();
  const std::size_t type = document.number(accessor, "componentType");
  charge(document.file(), out.count, out.components * sizeof(double));
  out.values.resize(out.count * out.components);
  for (std::size_t i = 0; i < out.count; ++i) {
    const auto at = attribute.mapped_index(draco::PointIndex(static_cast<std::uint32_t>(i)));
    double* values = &out.values[i * out.components];
    if (at.value() >= attribute.size() ||
        !attribute.ConvertValue(at, static_cast<std::int8_t>(out.components), values))
      throw document.bad("an attribute of a mesh packed by Draco cannot be read");
    for (std::size_t k = 0; k < out.components && normalize; ++k)
      values[k] = normalized(values[k], type);
  }
  return out;
}

}  // namespace

std::optional<GltfDraco> decodeDraco(const GltfDocument& document, const Json& primitive,
                                     const std::set<std::string>& names) {
  const Json& extension = GltfDocument::member(GltfDocument::member(primitive, "extensions"),
                                               "KHR_draco_mesh_compression");
  if (!extension.contains("bufferView")) return std::nullopt;
  const Json& accessors = GltfDocument::member(primitive, "attributes");
  const auto accessorOf = [&](const std::string& name) -> const Json& {
    return document.at("accessors", document.number(accessors, name.c_str(), 0xffffffff));
  };
  if (accessorOf("POSITION").contains("bufferView")) return std::nullopt;

  const std::string_view stream = document.bufferView(document.number(extension, "bufferView"));
  const std::unique_ptr<draco::Mesh> mesh = decode(stream, document.file());
  if (mesh == nullptr)
    throw document.bad("a mesh packed by Draco (" + std::to_string(stream.size()) +
                       " bytes) cannot be unpacked");
  GltfDraco out;
  const Json& ids = GltfDocument::member(extension, "attributes");
  for (const std::string& name : names) {
    const auto id = ids.find(name);
    if (id == ids.end()) continue;
    checkpoint(document.file());
    const draco::PointAttribute* attribute = mesh->GetAttributeByUniqueId(id->get<std::uint32_t>());
    if (attribute == nullptr)
      throw document.bad("a mesh packed by Draco has no attribute for " + inQuotes(name));
    out.attributes.emplace(name, dracoValues(document, *mesh, *attribute, accessorOf(name)));
  }
  out.triangles.reserve(mesh->num_faces());
  for (std::uint32_t i = 0; i < mesh->num_faces(); ++i) {
    const draco::Mesh::Face& face = mesh->face(draco::FaceIndex(i));
    const glm::uvec3 t(face[0].value(), face[1].value(), face[2].value());
    if (t.x >= mesh->num_points() || t.y >= mesh->num_points() || t.z >= mesh->num_points())
      throw document.bad("a mesh packed by Draco uses a point that it does not have");
    out.triangles.push_back(t);
  }
  return out;
}

}  // namespace sherd
