// Meshes as Draco's own encoder packs them.
#pragma once

#include <draco/compression/expert_encode.h>
#include <sherd/mesh.h>

#include <cstdint>
#include <glm/gtc/type_precision.hpp>
#include <stdexcept>
#include <string>

namespace sherd {

/// The attributes' unique ids in a stream of dracoStream().
inline constexpr std::uint32_t kDracoPositions = 0, kDracoColors = 1;

/// A mesh with a color for each vertex: (255, 255, 0) and (0, 255, 0) by turns.
///   method  draco::MESH_SEQUENTIAL_ENCODING or MESH_EDGEBREAKER_ENCODING
///   bytes   what the colors' bytes are said to be
inline std::string dracoStream(const TriangleMesh& mesh, int method,
                               draco::DataType bytes = draco::DT_UINT8) {
  draco::Mesh source;
  const auto count = static_cast<std::uint32_t>(mesh.vertices.size());
  source.set_num_points(count);
  draco::GeometryAttribute position, color;
  position.Init(draco::GeometryAttribute::POSITION, nullptr, 3, draco::DT_FLOAT32, false, 12, 0);
  color.Init(draco::GeometryAttribute::COLOR, nullptr, 4, bytes, false, 4, 0);
  const int positions = source.AddAttribute(position, true, count);
  const int colors = source.AddAttribute(color, true, count);
  for (std::uint32_t i = 0; i < count; ++i) {
    const glm::vec3 at(mesh.vertices[i]);
    const glm::u8vec4 byte(i % 2 * 255, 255, 0, 255);
    source.attribute(positions)->SetAttributeValue(draco::AttributeValueIndex(i), &at);
    source.attribute(colors)->SetAttributeValue(draco::AttributeValueIndex(i), &byte);
  }
  source.SetNumFaces(mesh.triangles.size());
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const glm::uvec3& t = mesh.triangles[i];
    source.SetFace(draco::FaceIndex(i),
                   {draco::PointIndex(t.x), draco::PointIndex(t.y), draco::PointIndex(t.z)});
  }
  draco::ExpertEncoder encoder(source);
  encoder.SetEncodingMethod(method);
  encoder.SetAttributeQuantization(positions, 11);  // keeps small whole numbers
  draco::EncoderBuffer out;
  const bool good = encoder.EncodeToBuffer(&out).ok() &&
                    source.attribute(positions)->unique_id() == kDracoPositions &&
                    source.attribute(colors)->unique_id() == kDracoColors;
  if (!good) throw std::logic_error("Draco does not encode");
  return {out.data(), out.size()};
}

}  // namespace sherd
