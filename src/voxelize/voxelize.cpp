// From a closed mesh to a solid.
#include <sherd/error.h>
#include <sherd/solid.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "mesh/turned_over.h"
#include "mesh/winding_number.h"
#include "voxelize/distance.h"
#include "voxelize/specks.h"
#include "voxelize/winding.h"

namespace sherd {
namespace {

constexpr int kLargestResolution = 4096;

double longestSide(const TriangleMesh& mesh) {
  const Box box = bounds(mesh);
  const glm::dvec3 size = box.max - box.min;
  return std::max({size.x, size.y, size.z});
}

TriangleMesh inIndexSpace(TriangleMesh mesh, const GridFrame& frame) {
  for (glm::dvec3& v : mesh.vertices) v = frame.indexFromWorld({v}).v;
  return mesh;
}

// The connected parts of a mesh, each with the vertices it uses.
std::vector<TriangleMesh> separated(const TriangleMesh& mesh) {
  const Components parts = components(mesh);
  std::vector<TriangleMesh> meshes(parts.count);
  std::vector<std::uint32_t> moved(mesh.vertices.size(), std::numeric_limits<std::uint32_t>::max());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    TriangleMesh& part = meshes[parts.ofTriangle[t]];
    glm::uvec3 triangle = mesh.triangles[t];
    for (int k = 0; k < 3; ++k) {  // parts share no vertex, so one table serves all
      std::uint32_t& place = moved[triangle[k]];
      if (place == std::numeric_limits<std::uint32_t>::max()) {
        place = static_cast<std::uint32_t>(part.vertices.size());
        part.vertices.push_back(mesh.vertices[triangle[k]]);
      }
      triangle[k] = place;
    }
    part.triangles.push_back(triangle);
  }
  return meshes;
}

void append(TriangleMesh& mesh, const TriangleMesh& other) {
  const auto first = static_cast<unsigned>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const glm::uvec3& t : other.triangles) mesh.triangles.push_back(t + first);
}

// The bodies of a mesh whose parts overlap: each an outward part with the inward parts (cavities)
// inside it.  An inward part that lies in no other is a body turned inside out, and is turned back.
std::vector<TriangleMesh> bodies(const TriangleMesh& mesh) {
  std::vector<TriangleMesh> outward, inward;
  for (TriangleMesh& part : separated(mesh)) {
    (volume(part) >= 0 ? outward : inward).push_back(std::move(part));
  }

  std::vector<double> size;
  for (const TriangleMesh& part : outward) size.push_back(volume(part));
  const std::size_t hosts = outward.size();
  std::vector<TriangleMesh> whole = outward;
  for (TriangleMesh& part : inward) {
    std::size_t host = hosts;
    const glm::dvec3 p = part.vertices.front();
    for (std::size_t h = 0; h < hosts; ++h) {
      if ((host == hosts || size[h] < size[host]) && windingNumber(outward[h], p) > 0.5) host = h;
    }
    if (host == hosts) {
      part = turnedOver(std::move(part));
      whole.push_back(std::move(part));
    } else {
      append(whole[host], part);
    }
  }
  return whole;
}

}  // namespace

double voxelSizeFor(const TriangleMesh& mesh, const SolidOptions& options) {
  const double longest = longestSide(mesh);
  if (!(longest > 0.0) || !std::isfinite(longest)) {
    throw Error(ErrorCode::input, "the mesh's box has no size that can be divided into voxels");
  }
  if (options.voxelSize == 0.0) {
    if (options.resolution < 8 || options.resolution > kLargestResolution) {
      throw Error(ErrorCode::usage, "a resolution of " + std::to_string(options.resolution) +
                                        " was asked for, 8 to " +
                                        std::to_string(kLargestResolution) + " are possible");
    }
    return longest / options.resolution;
  }
  if (!(options.voxelSize > 0.0) || !(longest / options.voxelSize <= kLargestResolution)) {
    std::ostringstream text;
    text << "a voxel size of " << options.voxelSize << " was asked for; the mesh is " << longest
         << " long, so it has to be " << longest / kLargestResolution << " or more";
    throw Error(ErrorCode::usage, text.str());
  }
  return options.voxelSize;
}

Solid voxelize(const TriangleMesh& source, const SolidOptions& options, const Progress* progress) {
  step(progress, "voxelize", 0.0);
  if (const std::size_t open = openEdges(source); open > 0) {
    throw Error(ErrorCode::input,
                std::to_string(open) +
                    " edges of the mesh are open or turned against their neighbour; a closed mesh "
                    "is needed");
  }
  Solid solid;
  solid.frame.voxelSize = voxelSizeFor(source, options);
  solid.frame.origin.v = bounds(source).min + 0.5 * solid.frame.voxelSize;

  TriangleMesh mesh = inIndexSpace(source, solid.frame);
  if (volume(mesh) < 0) mesh = turnedOver(std::move(mesh));
  const Winding winding(mesh);
  step(progress, "voxelize", 0.1);

  if (winding.lowest() >= 0 && winding.highest() <= 1) {
    solid.distance = levelSetFromMesh(mesh, winding, solid.frame, progress);
  } else {
    // Surfaces inside other bodies are no surfaces of the solid: unite the bodies one by one.
    const std::vector<TriangleMesh> all = bodies(mesh);
    FloatGridPtr whole;
    for (const TriangleMesh& body : all) {
      FloatGridPtr grid = levelSetFromMesh(body, Winding(body), solid.frame, progress);
      if (whole) {
        unite(*whole, *grid);
      } else {
        whole = std::move(grid);
      }
    }
    solid.distance = whole;
  }
  solid.blocks = leafBlocks(*solid.distance);
  measureVoxels(solid);
  if (solid.voxels == 0) {
    throw Error(ErrorCode::input, "no voxel centre lies inside the mesh at a voxel size of " +
                                      std::to_string(solid.frame.voxelSize) +
                                      "; try a higher --resolution");
  }
  step(progress, "voxelize", 1.0);
  return solid;
}

}  // namespace sherd
