// Writes points and distance samples.
#include <sherd/files.h>

#include <array>
#include <string>

#include "base/half_float.h"
#include "base/little_endian.h"
#include "base/number_text.h"
#include "formats/arrays/npz.h"
#include "formats/points/octree_stream.h"

namespace sherd {
namespace {

void storeFloats(std::string& bytes, const glm::dvec3& v) {
  std::array<char, 3 * sizeof(float)> little;
  for (int axis = 0; axis < 3; ++axis) {
    keepLittle(little.data() + sizeof(float) * static_cast<std::size_t>(axis),
               static_cast<float>(v[axis]));
  }
  bytes.append(little.data(), little.size());
}

std::string plyBytes(const SurfacePoints& points) {
  const std::size_t n = points.positions.size();
  const bool hasNormals = !points.normals.empty(), hasNeighbor = !points.neighbor.empty();
  std::string bytes = "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(n) +
                      "\nproperty float x\nproperty float y\nproperty float z\n";
  if (hasNormals) bytes += "property float nx\nproperty float ny\nproperty float nz\n";
  if (hasNeighbor) bytes += "property int neighbor\n";
  bytes += "end_header\n";
  bytes.reserve(bytes.size() + 28 * n);
  for (std::size_t i = 0; i < n; ++i) {
    storeFloats(bytes, points.positions[i]);
    if (hasNormals) storeFloats(bytes, points.normals[i]);
    if (hasNeighbor) storeLittle(bytes, std::uint32_t{points.neighbor[i]});
  }
  return bytes;
}

// The shortest decimals that read back as the same float.
std::string xyzText(const SurfacePoints& points) {
  std::string text;
  const int columns = points.normals.empty() ? 3 : 6;
  for (std::size_t i = 0; i < points.positions.size(); ++i) {
    for (int k = 0; k < columns; ++k) {
      const double value = k < 3 ? points.positions[i][k] : points.normals[i][k - 3];
      appendShortest(text, static_cast<float>(value));
      text.push_back(k + 1 < columns ? ' ' : '\n');
    }
  }
  return text;
}

void writePointsNpz(const OutputFile& file, const SurfacePoints& points) {
  const std::size_t n = points.positions.size();
  std::vector<NpyArray> arrays{{"positions", "<f4", {n, 3}, {}}};
  for (const glm::dvec3& at : points.positions) storeFloats(arrays.back().bytes, at);
  if (!points.normals.empty()) {
    arrays.push_back({"normals", "<f4", {n, 3}, {}});
    for (const glm::dvec3& normal : points.normals) storeFloats(arrays.back().bytes, normal);
  }
  if (!points.neighbor.empty()) {
    arrays.push_back({"neighbor", "<i4", {n}, {}});
    for (const std::uint16_t id : points.neighbor) {
      storeLittle(arrays.back().bytes, std::uint32_t{id});
    }
  }
  writeNpz(file, arrays);
}

}  // namespace

void writePoints(const OutputFile& file, const SurfacePoints& points, PointFormat format) {
  switch (format) {
    case PointFormat::ply:
      return file.write(plyBytes(points));
    case PointFormat::xyz:
      return file.write(xyzText(points));
    case PointFormat::npz:
      return writePointsNpz(file, points);
    case PointFormat::binp:
      return file.write(octreeStream(points.positions, file.string()).bytes);
  }
}

std::vector<std::string> lossesOf(const SurfacePoints& points, PointFormat format) {
  std::vector<std::string> losses;
  if (!points.neighbor.empty() && (format == PointFormat::xyz || format == PointFormat::binp)) {
    losses.push_back("neighbor ids of points are left out");
  }
  if (format != PointFormat::binp) return losses;
  if (!points.normals.empty()) losses.push_back("normals are left out");
  const OctreeStream stream = octreeStream(points.positions, "points");
  std::string voxel;
  appendShortest(voxel, static_cast<float>(stream.voxelSize));
  losses.push_back("positions are rounded to voxels of " + voxel + ", in the octree's order");
  if (stream.merged > 0) {
    losses.push_back(std::to_string(stream.merged) +
                     " points that share a voxel with another are left out");
  }
  return losses;
}

void writeCorrespondences(const OutputFile& file, const Correspondences& points) {
  const std::size_t n = points.positions.size();
  std::array<NpyArray, 3> arrays{{{"fragments", "<i4", {n, 2}, {}},
                                  {"positions", "<f4", {n, 3}, {}},
                                  {"normals", "<f4", {n, 3}, {}}}};
  for (std::size_t i = 0; i < n; ++i) {
    for (const int id : points.fragments[i]) {
      storeLittle(arrays[0].bytes, static_cast<std::uint32_t>(id));
    }
    for (int axis = 0; axis < 3; ++axis) {
      storeLittle(arrays[1].bytes, static_cast<float>(points.positions[i][axis]));
      storeLittle(arrays[2].bytes, static_cast<float>(points.normals[i][axis]));
    }
  }
  writeNpz(file, arrays);
}

void writeDistances(const OutputFile& file, const DistanceSamples& samples) {
  const bool half = samples.type == SampleType::float16;
  const auto store = [&](std::string& bytes, double value) {
    if (half) {
      storeLittle(bytes, halfBits(roundedToHalf(value)));
    } else {
      storeLittle(bytes, static_cast<float>(value));
    }
  };
  const std::size_t n = samples.positions.size();
  const std::string_view type = half ? "<f2" : "<f4";
  std::array<NpyArray, 2> arrays{{{"positions", type, {n, 3}, {}}, {"sdf", type, {n}, {}}}};
  for (std::size_t i = 0; i < n; ++i) {
    for (int axis = 0; axis < 3; ++axis) store(arrays[0].bytes, samples.positions[i][axis]);
    store(arrays[1].bytes, samples.distances[i]);
  }
  writeNpz(file, arrays);
}

}  // namespace sherd
