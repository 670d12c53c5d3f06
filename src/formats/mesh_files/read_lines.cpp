// Reads the lines of a mesh file.
#include "formats/mesh_files/read_lines.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "formats/mesh/polylines.h"
#include "formats/obj/obj_lines.h"
#include "formats/ply/ply_body.h"

namespace sherd {
namespace {

using Edge = std::array<std::uint32_t, 2>;

constexpr std::size_t kLinesAtATime = 4096;  // vertices or edges between two checks
constexpr double kLargest = 1e37;            // coordinate: its square does not overflow

// Vertices and edges as they are read, charged as they grow.
struct Lines {
  const MeshFile& file;
  std::vector<glm::dvec3> vertices{};
  std::vector<Edge> edges{};
  bool hasFaces = false;
  GrowingMemory memory{file.memory};
  std::size_t read = 0;

  // To be called for each vertex and edge.  Joining takes two numbers for a vertex, and for an edge
  // four and a point.
  void checkMemory() {
    if (++read % kLinesAtATime != 0) return;
    checkpoint(file);
    memory.hold(vertices.size() * (sizeof(glm::dvec3) + 2 * sizeof(std::size_t)) +
                edges.size() * (2 * sizeof(Edge) + 2 * sizeof(std::size_t) + sizeof(glm::dvec3)));
  }

  FileLines joined() {
    read = kLinesAtATime - 1;
    checkMemory();
    for (const Edge& edge : edges) {
      for (const std::uint32_t v : edge) {
        const glm::dvec3& at = vertices[v];
        const bool isGood =
            std::abs(at.x) <= kLargest && std::abs(at.y) <= kLargest && std::abs(at.z) <= kLargest;
        if (!isGood) {
          throw inputError(
              file, "vertex " + std::to_string(v + 1) + " of a line is not finite, or above 1e37");
        }
      }
    }
    return {joinedPolylines(vertices, edges), hasFaces};
  }
};

class ObjLineReader {
 public:
  explicit ObjLineReader(const MeshFile& file) : file_(file), lines_{file} {}

  FileLines read() {
    ObjLines text(withoutByteOrderMark(file_.bytes));
    while (text.next()) {
      std::string_view rest = text.line();
      const std::string_view keyword = takeWord(rest);
      rest = rest.substr(0, rest.find('#'));
      if (keyword == "v") addVertex(rest, text.number());
      if (keyword == "l") addLine(rest, text.number());
      if (keyword == "f") lines_.hasFaces = true;
    }
    // Vertices may follow the lines that use them.
    if (largest_ > lines_.vertices.size()) {
      throw inputError(file_, largestLine_,
                       "line uses vertex " + std::to_string(largest_) + ", the file has " +
                           std::to_string(lines_.vertices.size()));
    }
    return lines_.joined();
  }

 private:
  void addVertex(std::string_view rest, std::size_t number) {
    glm::dvec3 at(0.0);
    for (int axis = 0; axis < 3; ++axis) {
      const std::optional<double> value = parseReal(takeWord(rest));
      if (!value) throw inputError(file_, number, "vertex has less than 3 coordinates");
      at[axis] = *value;
    }
    lines_.vertices.push_back(at);
    lines_.checkMemory();
  }

  // Numbers below 0 count from the end; texture coordinates may follow a slash.
  std::uint32_t vertexOf(std::string_view word, std::size_t number) {
    const auto index = parseInteger<std::int64_t>(word.substr(0, word.find('/')));
    const auto count = static_cast<std::int64_t>(lines_.vertices.size());
    constexpr std::int64_t kMost = std::numeric_limits<std::uint32_t>::max();
    if (!index || *index == 0 || *index < -count || *index > kMost) {
      throw inputError(file_, number, "line has " + inQuotes(word) + ", not a vertex number");
    }
    if (*index < 0) return static_cast<std::uint32_t>(count + *index);
    if (static_cast<std::size_t>(*index) > largest_) {
      largest_ = static_cast<std::size_t>(*index);
      largestLine_ = number;
    }
    return static_cast<std::uint32_t>(*index - 1);
  }

  void addLine(std::string_view rest, std::size_t number) {
    std::optional<std::uint32_t> before;
    std::size_t points = 0;
    for (std::string_view word = takeWord(rest); !word.empty(); word = takeWord(rest), ++points) {
      const std::uint32_t vertex = vertexOf(word, number);
      if (before) lines_.edges.push_back({*before, vertex});
      before = vertex;
      lines_.checkMemory();
    }
    if (points < 2) throw inputError(file_, number, "line has less than 2 vertices");
  }

  const MeshFile& file_;
  Lines lines_;
  std::size_t largest_ = 0, largestLine_ = 0;  // vertex used, from 1
};

// Returns which of the properties has one of the names; their number if none has.
std::size_t indexOf(const PlyElement& element, const char* name) {
  const auto found =
      std::find_if(element.properties.begin(), element.properties.end(),
                   [&](const PlyProperty& p) { return p.name == name && !p.listCount; });
  return static_cast<std::size_t>(found - element.properties.begin());
}

class PlyLineReader {
 public:
  explicit PlyLineReader(const MeshFile& file)
      : file_(file), header_(readPlyHeader(file)), lines_{file} {}

  FileLines read() {
    PlyBody body(file_, header_);
    for (const PlyElement& element : header_.elements) {
      if (element.properties.empty() && element.count > 0)
        throw inputError(file_, "element " + inQuotes(element.name) + " has no properties");
      const bool isFace = element.name == "face" || element.name == "tristrips";
      lines_.hasFaces = lines_.hasFaces || (isFace && element.count > 0);
      if (element.name == "vertex") {
        const std::size_t places[3] = {needed(element, "x"), needed(element, "y"),
                                       needed(element, "z")};
        readAll(body, element, [&](const std::vector<double>& values) {
          lines_.vertices.emplace_back(values[places[0]], values[places[1]], values[places[2]]);
        });
      } else if (element.name == "edge") {
        const std::size_t places[2] = {needed(element, "vertex1"), needed(element, "vertex2")};
        readAll(body, element, [&](const std::vector<double>& values) {
          lines_.edges.push_back({vertexOf(values[places[0]]), vertexOf(values[places[1]])});
        });
      } else {
        readAll(body, element, [](const std::vector<double>&) {});
      }
    }
    body.finish();
    for (const Edge& edge : lines_.edges) {  // vertices may follow the edges
      if (std::max(edge[0], edge[1]) < lines_.vertices.size()) continue;
      throw inputError(file_, "an edge uses vertex " + std::to_string(std::max(edge[0], edge[1])) +
                                  ", the file has " + std::to_string(lines_.vertices.size()));
    }
    return lines_.joined();
  }

 private:
  [[nodiscard]] std::size_t needed(const PlyElement& element, const char* name) const {
    const std::size_t index = indexOf(element, name);
    if (index < element.properties.size()) return index;
    throw inputError(file_, "its element " + inQuotes(element.name) + " has no " + name);
  }

  [[nodiscard]] std::uint32_t vertexOf(double value) const {
    const bool isIndex = value >= 0.0 && value < std::numeric_limits<std::uint32_t>::max() &&
                         value == std::floor(value);
    if (isIndex) return static_cast<std::uint32_t>(value);
    throw inputError(file_, "an edge uses a vertex that is not a whole number from 0");
  }

  // Calls use(values of its numbers) for each item of an element; lists count as 0.
  template <class Use>
  void readAll(PlyBody& body, const PlyElement& element, const Use& use) {
    std::vector<double> values(element.properties.size());
    for (std::size_t i = 0; i < element.count; ++i) {
      body.begin(element, i);
      for (std::size_t k = 0; k < values.size(); ++k) {
        const PlyProperty& property = element.properties[k];
        if (!property.listCount) {
          values[k] = body.number(property.value);
          continue;
        }
        const std::int64_t length = body.integer(*property.listCount);
        if (length < 0) throw body.bad("has a list of negative length");
        body.skip(property.value, static_cast<std::size_t>(length));
      }
      body.end();
      use(values);
      lines_.checkMemory();
    }
  }

  const MeshFile& file_;
  PlyHeader header_;
  Lines lines_;
};

}  // namespace

FileLines readObjLines(const MeshFile& file) { return ObjLineReader(file).read(); }

FileLines readPlyLines(const MeshFile& file) { return PlyLineReader(file).read(); }

}  // namespace sherd
