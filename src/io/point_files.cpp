// Points and distance samples as files.
#include <sherd/io.h>

#include <array>
#include <charconv>
#include <string>

#include "half_float.h"
#include "io/atomic_file.h"
#include "io/little_endian.h"
#include "io/npz.h"

namespace sherd {
namespace {

void storeFloats(std::string& bytes, const glm::dvec3& v) {
  for (int axis = 0; axis < 3; ++axis) storeLittle(bytes, static_cast<float>(v[axis]));
}

std::string plyBytes(const SurfacePoints& points) {
  const std::size_t n = points.positions.size();
  std::string bytes = "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(n) +
                      "\nproperty float x\nproperty float y\nproperty float z\n"
                      "property float nx\nproperty float ny\nproperty float nz\n"
                      "property int facing\nend_header\n";
  bytes.reserve(bytes.size() + 28 * n);
  for (std::size_t i = 0; i < n; ++i) {
    storeFloats(bytes, points.positions[i]);
    storeFloats(bytes, points.normals[i]);
    storeLittle(bytes, std::uint32_t{points.facing[i]});
  }
  return bytes;
}

// The shortest decimals that read back as the same float.
std::string xyzText(const SurfacePoints& points) {
  std::string text;
  std::array<char, 32> digits;
  for (std::size_t i = 0; i < points.positions.size(); ++i) {
    for (int k = 0; k < 6; ++k) {
      const double value = k < 3 ? points.positions[i][k] : points.normals[i][k - 3];
      const auto [end, error] =
          std::to_chars(digits.data(), digits.data() + digits.size(), static_cast<float>(value));
      text.append(digits.data(), end).push_back(k < 5 ? ' ' : '\n');
    }
  }
  return text;
}

void writePointsNpz(const std::filesystem::path& file, const SurfacePoints& points) {
  const std::size_t n = points.positions.size();
  std::array<NpyArray, 3> arrays{{{"positions", "<f4", {n, 3}, {}},
                                  {"normals", "<f4", {n, 3}, {}},
                                  {"facing", "<i4", {n}, {}}}};
  for (std::size_t i = 0; i < n; ++i) {
    storeFloats(arrays[0].bytes, points.positions[i]);
    storeFloats(arrays[1].bytes, points.normals[i]);
    storeLittle(arrays[2].bytes, std::uint32_t{points.facing[i]});
  }
  writeNpz(file, arrays);
}

}  // namespace

void writePoints(const std::filesystem::path& file, const SurfacePoints& points,
                 PointFormat format) {
  switch (format) {
    case PointFormat::ply:
      return writeWhole(file, plyBytes(points));
    case PointFormat::xyz:
      return writeWhole(file, xyzText(points));
    case PointFormat::npz:
      return writePointsNpz(file, points);
  }
}

void writeCorrespondences(const std::filesystem::path& file, const Correspondences& points) {
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

void writeDistances(const std::filesystem::path& file, const DistanceSamples& samples) {
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
