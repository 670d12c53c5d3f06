// Writes points and distance samples.
#include <sherd/files.h>

#include <array>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/half_float.h"
#include "base/little_endian.h"
#include "base/text/number_text.h"
#include "formats/arrays/npz.h"
#include "formats/points/octree_stream.h"
#include "formats/points/write_blocks.h"

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

void storeFloats(std::string& bytes, std::span<const glm::dvec3> values) {
  bytes.reserve(bytes.size() + 12 * values.size());
  for (const glm::dvec3& v : values) storeFloats(bytes, v);
}

std::string plyHeader(std::size_t count, const SurfacePoints& first) {
  std::string text = "ply\nformat binary_little_endian 1.0\nelement vertex " +
                     std::to_string(count) +
                     "\nproperty float x\nproperty float y\nproperty float z\n";
  if (!first.normals.empty()) text += "property float nx\nproperty float ny\nproperty float nz\n";
  if (!first.neighbor.empty()) text += "property int neighbor\n";
  return text + "end_header\n";
}

std::string plyBytes(const SurfacePoints& points) {
  const bool hasNormals = !points.normals.empty(), hasNeighbor = !points.neighbor.empty();
  std::string bytes;
  bytes.reserve(28 * points.positions.size());
  for (std::size_t i = 0; i < points.positions.size(); ++i) {
    storeFloats(bytes, points.positions[i]);
    if (hasNormals) storeFloats(bytes, points.normals[i]);
    if (hasNeighbor) storeLittle(bytes, std::uint32_t{points.neighbor[i]});
  }
  return bytes;
}

void writePly(const Blocks<SurfacePoints>& points, const ByteSink& sink) {
  bool hasHeader = false;
  points.forEach([&](const SurfacePoints& block) {
    if (!std::exchange(hasHeader, true)) sink(plyHeader(points.count, block));
    sink(plyBytes(block));
  });
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

// A column of samples as an array.
template <class Block>
struct Column {
  NpyArray array;
  std::function<void(std::string& bytes, const Block& block)> store;
  bool isOptional = false;  // left out if it has no numbers
};

// Writes samples as an array for each column.  A ZIP file has a sum of each file before its bytes,
// so the samples are made once for all sums, and once for each array; none is held.
template <class Block>
void writeColumns(const OutputFile& file, const Blocks<Block>& samples,
                  const std::vector<Column<Block>>& columns) {
  std::vector<PackedFile> files;
  std::vector<bool> hasNumbers(columns.size(), false);
  for (const Column<Block>& column : columns) files.push_back(storedFile(column.array));
  samples.forEach([&](const Block& block) {
    for (std::size_t i = 0; i < columns.size(); ++i) {
      std::string bytes;
      columns[i].store(bytes, block);
      hasNumbers[i] = hasNumbers[i] || !bytes.empty();
      addStored(files[i], bytes);
    }
  });
  file.write([&](const ByteSink& sink) {
    NpzWriter writer(sink);
    for (std::size_t i = 0; i < columns.size(); ++i) {
      if (columns[i].isOptional && !hasNumbers[i]) continue;
      const Content numbers = [&](const ByteSink& to) {
        constexpr std::size_t kAtOnce = std::size_t{1} << 20;  // blocks may be small
        std::string bytes;
        samples.forEach([&](const Block& block) {
          columns[i].store(bytes, block);
          if (bytes.size() < kAtOnce) return;
          to(bytes);
          bytes.clear();
        });
        to(bytes);
      };
      writer.store(columns[i].array, numbers, files[i]);
    }
    writer.finish();
  });
}

void writePointsNpz(const OutputFile& file, const Blocks<SurfacePoints>& points) {
  const std::size_t n = points.count;
  using Columns = std::vector<Column<SurfacePoints>>;
  const auto positions = [](std::string& bytes, const SurfacePoints& block) {
    storeFloats(bytes, block.positions);
  };
  const auto normals = [](std::string& bytes, const SurfacePoints& block) {
    storeFloats(bytes, block.normals);
  };
  const auto neighbors = [](std::string& bytes, const SurfacePoints& block) {
    for (const std::uint16_t id : block.neighbor) storeLittle(bytes, std::uint32_t{id});
  };
  writeColumns(file, points,
               Columns{{{"positions", "<f4", {n, 3}, {}}, positions},
                       {{"normals", "<f4", {n, 3}, {}}, normals, true},
                       {{"neighbor", "<i4", {n}, {}}, neighbors, true}});
}

// Appends a number of a sample type.
void store(std::string& bytes, double value, SampleType type) {
  if (type == SampleType::float16) {
    storeLittle(bytes, halfBits(roundedToHalf(value)));
  } else {
    storeLittle(bytes, static_cast<float>(value));
  }
}

std::string positionBytes(std::span<const glm::dvec3> positions, SampleType type) {
  std::string bytes;
  bytes.reserve(12 * positions.size());
  for (const glm::dvec3& p : positions) {
    for (int axis = 0; axis < 3; ++axis) store(bytes, p[axis], type);
  }
  return bytes;
}

}  // namespace

void writePoints(const OutputFile& file, const SurfacePoints& points, PointFormat format) {
  writePoints(file, oneBlock(points), format);
}

void writePoints(const OutputFile& file, const Blocks<SurfacePoints>& points, PointFormat format) {
  switch (format) {
    case PointFormat::ply:
      return file.write([&](const ByteSink& sink) { writePly(points, sink); });
    case PointFormat::xyz:
      return file.write([&](const ByteSink& sink) {
        points.forEach([&](const SurfacePoints& block) { sink(xyzText(block)); });
      });
    case PointFormat::npz:
      return writePointsNpz(file, points);
    case PointFormat::binp:
      return file.write(octreeStream(points, file.string()).bytes);
  }
}

std::vector<std::string> lossesOf(const SurfacePoints& points, PointFormat format) {
  std::vector<std::string> losses;
  if (!points.neighbor.empty() && (format == PointFormat::xyz || format == PointFormat::binp)) {
    losses.push_back("neighbor ids of points are left out");
  }
  if (format != PointFormat::binp) return losses;
  if (!points.normals.empty()) losses.push_back("normals are left out");
  const OctreeStream stream = octreeStream(oneBlock(points), "points");
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
  writeCorrespondences(file, oneBlock(points));
}

void writeCorrespondences(const OutputFile& file, const Blocks<Correspondences>& points) {
  const std::size_t n = points.count;
  using Columns = std::vector<Column<Correspondences>>;
  const auto fragments = [](std::string& bytes, const Correspondences& block) {
    for (const auto& pair : block.fragments) {
      for (const int id : pair) storeLittle(bytes, static_cast<std::uint32_t>(id));
    }
  };
  const auto positions = [](std::string& bytes, const Correspondences& block) {
    storeFloats(bytes, block.positions);
  };
  const auto normals = [](std::string& bytes, const Correspondences& block) {
    storeFloats(bytes, block.normals);
  };
  writeColumns(file, points,
               Columns{{{"fragments", "<i4", {n, 2}, {}}, fragments},
                       {{"positions", "<f4", {n, 3}, {}}, positions},
                       {{"normals", "<f4", {n, 3}, {}}, normals}});
}

void writeDistances(const OutputFile& file, const DistanceSamples& samples) {
  writeDistances(file, {oneBlock(samples),
                        [&samples](const auto& visit) { visit(samples.positions); }, samples.type});
}

// Positions are made twice; distances are held as they are stored, since they cost far more.
void writeDistances(const OutputFile& file, const DistanceBlocks& samples) {
  const std::size_t n = samples.samples.count;
  const std::string_view type = samples.type == SampleType::float16 ? "<f2" : "<f4";
  const NpyArray positions{"positions", type, {n, 3}, {}}, distances{"sdf", type, {n}, {}};
  PackedFile ofPositions = storedFile(positions), ofDistances = storedFile(distances);
  std::string held;
  held.reserve(n * (samples.type == SampleType::float16 ? 2 : 4));
  samples.samples.forEach([&](const DistanceSamples& block) {
    addStored(ofPositions, positionBytes(block.positions, samples.type));
    for (const double distance : block.distances) store(held, distance, samples.type);
  });
  addStored(ofDistances, held);
  file.write([&](const ByteSink& sink) {
    NpzWriter writer(sink);
    const Content numbers = [&](const ByteSink& to) {
      samples.forEachPositions(
          [&](std::span<const glm::dvec3> some) { to(positionBytes(some, samples.type)); });
    };
    writer.store(positions, numbers, ofPositions);
    writer.store(
        distances, [&](const ByteSink& to) { to(held); }, ofDistances);
    writer.finish();
  });
}

}  // namespace sherd
