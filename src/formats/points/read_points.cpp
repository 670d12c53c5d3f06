// Reads points on surfaces.
#include <sherd/files.h>

#include <array>
#include <cmath>
#include <iterator>

#include "base/files/file_bytes.h"
#include "base/finite.h"
#include "base/input_error.h"
#include "base/text/lower_case.h"
#include "base/text/option_names.h"
#include "base/text/text_scan.h"
#include "formats/arrays/npy_reader.h"
#include "formats/ply/ply_body.h"
#include "formats/points/parse_points.h"

namespace sherd {
namespace {

constexpr std::size_t kPointsAtATime = 4096;

// Charges the memory of the points and of those added before the next call.
void hold(GrowingMemory& memory, const SurfacePoints& points) {
  memory.hold((points.positions.size() + kPointsAtATime) * sizeof(glm::dvec3) +
              points.normals.size() * sizeof(glm::dvec3) +
              points.neighbor.size() * sizeof(std::uint16_t));
}

void requireFinite(const SurfacePoints& points, const std::string& name) {
  for (std::size_t i = 0; i < points.positions.size(); ++i) {
    if (isFinite(points.positions[i])) continue;
    inputError(name, "point " + std::to_string(i + 1) + " is not finite");
  }
}

std::uint16_t neighborOf(double value, const std::string& name) {
  if (!(value >= 0.0 && value <= 65535.0 && value == std::floor(value))) {
    inputError(name, "a point's neighbor is no fragment id");
  }
  return static_cast<std::uint16_t>(value);
}

/// The vertex properties that are read: 0 to 2 position, 3 to 5 normal, 6 neighbor.
constexpr std::array<std::string_view, 7> kColumns{"x", "y", "z", "nx", "ny", "nz", "neighbor"};

struct VertexLayout {
  std::vector<std::size_t> column;  // index into kColumns, or its size: ignored
  bool positions = false, normals = false, neighbor = false;
};

VertexLayout layoutOf(const PlyElement& vertex) {
  VertexLayout layout;
  std::array<bool, kColumns.size() + 1> has{};
  for (const PlyProperty& property : vertex.properties) {
    const auto found = property.listCount
                           ? kColumns.end()
                           : std::find(kColumns.begin(), kColumns.end(), property.name);
    layout.column.push_back(static_cast<std::size_t>(found - kColumns.begin()));
    has[layout.column.back()] = true;
  }
  layout.positions = has[0] && has[1] && has[2];
  layout.normals = has[3] && has[4] && has[5];
  layout.neighbor = has[6];
  return layout;
}

// Returns three numbers per point.
std::vector<glm::dvec3> vectorsOf(const NpyNumbers& numbers, const std::string& name) {
  if (numbers.shape.size() != 2 || numbers.shape[1] != 3) {
    inputError(name, "has an array of vectors that is not [n, 3]");
  }
  std::vector<glm::dvec3> vectors;
  vectors.reserve(numbers.values.size() / 3);
  for (std::size_t i = 0; i < numbers.values.size(); i += 3) {
    vectors.emplace_back(numbers.values[i], numbers.values[i + 1], numbers.values[i + 2]);
  }
  return vectors;
}

}  // namespace

std::optional<PointFormat> pointFormatOf(const std::filesystem::path& file) {
  const std::string extension = lowerCase(file.extension().string());
  for (std::size_t i = 0; i < std::size(names::kPointFormat); ++i) {
    if (extension == std::string(".") + names::kPointFormat[i]) return static_cast<PointFormat>(i);
  }
  return {};
}

SurfacePoints parsePlyPoints(std::string_view bytes, const std::string& name,
                             const ReadOptions& options) {
  MemoryBudget memory(name, options.maxMemory);
  memory.charge(bytes.size());
  const MeshFile file{name, name, MeshFormat::ply, std::string(bytes)};
  const PlyHeader header = readPlyHeader(file);
  SurfacePoints points;
  GrowingMemory growing(&memory);
  PlyBody body(file, header);
  bool found = false;
  for (const PlyElement& element : header.elements) {
    if (element.properties.empty() && element.count > 0) {
      inputError(name, "element " + inQuotes(element.name) + " has no properties");
    }
    const bool isVertex = element.name == "vertex";
    const VertexLayout layout = layoutOf(element);
    if (isVertex && !layout.positions) inputError(name, "its vertices have no x, y and z");
    found |= isVertex;
    for (std::size_t i = 0; i < element.count; ++i) {
      if (i % kPointsAtATime == 0) hold(growing, points);
      body.begin(element, i);
      std::array<double, kColumns.size() + 1> numbers{};
      for (std::size_t p = 0; p < element.properties.size(); ++p) {
        const PlyProperty& property = element.properties[p];
        if (!property.listCount) {
          numbers[layout.column[p]] = body.number(property.value);
          continue;
        }
        const std::int64_t length = body.integer(*property.listCount);
        if (length < 0) throw body.bad("has a list of negative length");
        body.skip(property.value, static_cast<std::size_t>(length));
      }
      body.end();
      if (!isVertex) continue;
      points.positions.emplace_back(numbers[0], numbers[1], numbers[2]);
      if (layout.normals) points.normals.emplace_back(numbers[3], numbers[4], numbers[5]);
      if (layout.neighbor) points.neighbor.push_back(neighborOf(numbers[6], name));
    }
  }
  body.finish();
  if (!found) inputError(name, "has no vertices");
  requireFinite(points, name);
  return points;
}

SurfacePoints parseXyz(std::string_view bytes, const std::string& name,
                       const ReadOptions& options) {
  MemoryBudget memory(name, options.maxMemory);
  SurfacePoints points;
  GrowingMemory growing(&memory);
  LineReader lines(bytes);
  std::string_view line;
  std::size_t columns = 0;
  while (nextDataLine(lines, line)) {
    if (points.positions.size() % kPointsAtATime == 0) hold(growing, points);
    const std::size_t words = countWords(line);
    if (columns == 0) columns = words;
    std::array<double, 6> numbers{};
    bool good = words == columns && (words == 3 || words == 6);
    for (std::size_t k = 0; k < words && good; ++k) {
      const auto value = parseReal(takeWord(line));
      good = value.has_value();
      numbers[k] = value.value_or(0.0);
    }
    if (!good) {
      inputError(name + ":" + std::to_string(lines.number()),
                 "every line needs three numbers, or every line six with a normal");
    }
    points.positions.emplace_back(numbers[0], numbers[1], numbers[2]);
    if (columns == 6) points.normals.emplace_back(numbers[3], numbers[4], numbers[5]);
  }
  if (points.positions.empty()) inputError(name, "holds no point");
  requireFinite(points, name);
  return points;
}

SurfacePoints parseNpzPoints(std::string_view bytes, const std::string& name,
                             const ReadOptions& options) {
  MemoryBudget memory(name, options.maxMemory);
  const std::vector<ZipEntry> entries = zipEntries(bytes, name, &memory);
  const auto positions = numbersOf(entries, "positions", 3 * kMaxPoints, name, memory);
  const auto normals = numbersOf(entries, "normals", 3 * kMaxPoints, name, memory);
  const auto neighbor = numbersOf(entries, "neighbor", kMaxPoints, name, memory);
  if (!positions) inputError(name, "has no array 'positions'");
  const std::size_t vectors = positions->values.size() + (normals ? normals->values.size() : 0);
  memory.charge(vectors, sizeof(double));
  if (neighbor) memory.charge(neighbor->values.size(), sizeof(std::uint16_t));
  SurfacePoints points;
  points.positions = vectorsOf(*positions, name);
  if (normals) points.normals = vectorsOf(*normals, name);
  if (neighbor) {
    points.neighbor.reserve(neighbor->values.size());
    for (const double id : neighbor->values) points.neighbor.push_back(neighborOf(id, name));
  }
  const std::size_t n = points.positions.size();
  if ((normals && points.normals.size() != n) || (neighbor && points.neighbor.size() != n)) {
    inputError(name, "its arrays are of different lengths");
  }
  requireFinite(points, name);
  return points;
}

SurfacePoints readPoints(const std::filesystem::path& file, const ReadOptions& options) {
  const std::optional<PointFormat> format = pointFormatOf(file);
  if (!format) inputError(file, "is no point file; supported are .ply .xyz .npz .binp");
  const std::string name = file.string();
  MemoryBudget memory(name, options.maxMemory);
  const std::string bytes = readFileBytes(file, &memory);
  const ReadOptions rest{.maxMemory = memory.left()};
  switch (*format) {
    case PointFormat::ply:
      return parsePlyPoints(bytes, name, rest);
    case PointFormat::xyz:
      return parseXyz(bytes, name, rest);
    case PointFormat::npz:
      return parseNpzPoints(bytes, name, rest);
    case PointFormat::binp:
      return parseBinp(bytes, name, rest);
  }
  return {};
}

}  // namespace sherd
