// Whether a PLY file is whole.
#include "mesh/completeness.h"
#include "mesh/ply_body.h"
#include "mesh/read_ply.h"
#include "mesh/text_scan.h"

namespace sherd {
namespace {

void checkHeader(const MeshFile& file, const PlyHeader& header) {
  bool hasCorners = false;
  std::size_t coordinates = 0;
  for (const PlyElement& element : header.elements) {
    if (element.properties.empty() && element.count > 0)
      throw inputError(file, "element " + inQuotes(element.name) + " has no properties");
    if (element.name == "tristrips")
      throw inputError(file, "triangle strips are not supported; save it with single faces");
    for (const PlyProperty& property : element.properties) {
      hasCorners |= isFaceCorners(element, property);
      coordinates += element.name == "vertex" && !property.listCount &&
                     (property.name == "x" || property.name == "y" || property.name == "z");
    }
  }
  if (coordinates != 3) throw inputError(file, "its vertices have no x, y and z");
  if (!hasCorners) throw inputError(file, "its faces have no list 'vertex_indices'");
}

}  // namespace

FileCounts checkPly(const MeshFile& file) {
  const PlyHeader header = readPlyHeader(file);
  checkHeader(file, header);
  std::size_t polygons = 0;
  PlyBody body(file, header);
  for (const PlyElement& element : header.elements) {
    for (std::size_t i = 0; i < element.count; ++i) {
      body.begin(element, i);
      for (const PlyProperty& property : element.properties) {
        if (!property.listCount) {
          body.skip(property.value, 1);
          continue;
        }
        const std::int64_t length = body.integer(*property.listCount);
        if (length < 0) throw body.bad("has a list of negative length");
        if (!isFaceCorners(element, property)) {
          body.skip(property.value, static_cast<std::size_t>(length));
          continue;
        }
        for (std::int64_t k = 0; k < length; ++k) {
          const std::int64_t index = body.integer(property.value);
          if (index < 0 || static_cast<std::size_t>(index) >= header.vertices) {
            throw body.bad("uses vertex " + std::to_string(index) + ", the file has " +
                           std::to_string(header.vertices));
          }
        }
        polygons += length >= 3;
      }
      body.end();
    }
  }
  body.finish();
  return {header.vertices, polygons, hasLook(header)};
}

}  // namespace sherd
