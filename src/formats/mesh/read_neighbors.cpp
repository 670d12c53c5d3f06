// Reads the neighbor ids of the faces of a fragment's mesh.
#include "formats/mesh/read_neighbors.h"

#include <array>
#include <bit>
#include <cstring>
#include <map>
#include <optional>
#include <sstream>
#include <string>

#include "base/file_bytes.h"

namespace sherd {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are copied from the file");

/// A property: a number, or a list of them with its length before it.
struct Property {
  std::string name;
  std::size_t bytes = 0;
  std::size_t lengthBytes = 0;  ///< 0: not a list
  bool floating = false;
};

struct Element {
  std::string name;
  std::size_t count = 0;
  std::vector<Property> properties;
};

std::size_t bytesOf(const std::string& type) {
  static const std::map<std::string, std::size_t> kBytes{
      {"char", 1},  {"uchar", 1},   {"int8", 1},   {"uint8", 1},  {"short", 2}, {"ushort", 2},
      {"int16", 2}, {"uint16", 2},  {"int", 4},    {"uint", 4},   {"int32", 4}, {"uint32", 4},
      {"float", 4}, {"float32", 4}, {"double", 8}, {"float64", 8}};
  const auto found = kBytes.find(type);
  return found == kBytes.end() ? 0 : found->second;
}

Property propertyOf(std::istringstream& words) {
  Property property;
  std::string type;
  words >> type;
  if (type == "list") {
    std::string length;
    words >> length >> type;
    property.lengthBytes = bytesOf(length);
  }
  property.bytes = bytesOf(type);
  property.floating = type.starts_with("float");
  words >> property.name;
  return property;
}

/// Returns the elements, and in `at` the offset of the body; nothing for another kind of file.
std::optional<std::vector<Element>> readHeader(const std::string& bytes, std::size_t& at) {
  const std::string end = "end_header\n";
  const std::size_t found = bytes.find(end);
  if (!bytes.starts_with("ply\n") || found == std::string::npos) return {};
  at = found + end.size();
  std::vector<Element> elements;
  std::istringstream lines(bytes.substr(0, found));
  bool binary = false;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string word;
    words >> word;
    if (word == "format") {
      words >> word;
      binary = word == "binary_little_endian";
    } else if (word == "element") {
      Element& element = elements.emplace_back();
      words >> element.name >> element.count;
    } else if (word == "property") {
      if (elements.empty()) return {};
      elements.back().properties.push_back(propertyOf(words));
      if (elements.back().properties.back().bytes == 0) return {};
    }
  }
  return binary ? std::optional(elements) : std::nullopt;
}

/// Reads numbers in sequence; good() is false once they end.
class Numbers {
 public:
  Numbers(const std::string& bytes, std::size_t at) : bytes_(bytes), at_(at) {}

  bool good() const { return good_; }

  /// The bits of the next number.
  std::uint64_t next(std::size_t bytes) {
    std::uint64_t bits = 0;
    if (bytes > bytes_.size() - at_) {
      good_ = false;
      return 0;
    }
    std::memcpy(&bits, bytes_.data() + at_, bytes);
    at_ += bytes;
    return bits;
  }

  /// Calls use(property, index in the list, bits) for each number of one item.
  template <class Use>
  void item(const Element& element, Use use) {
    for (const Property& property : element.properties) {
      const std::uint64_t length = property.lengthBytes ? next(property.lengthBytes) : 1;
      for (std::uint64_t i = 0; i < length && good_; ++i) use(property, i, next(property.bytes));
    }
  }

 private:
  const std::string& bytes_;
  std::size_t at_;
  bool good_ = true;
};

using Position = std::array<float, 3>;

Position positionOf(Numbers& numbers, const Element& vertex) {
  Position position{};
  numbers.item(vertex, [&](const Property& property, std::uint64_t, std::uint64_t bits) {
    if (!property.floating || property.name.size() != 1) return;
    const std::size_t axis = static_cast<std::size_t>(property.name[0] - 'x');
    if (axis < 3) position[axis] = std::bit_cast<float>(static_cast<std::uint32_t>(bits)) + 0.0f;
  });
  return position;
}

struct Face {
  std::array<std::uint64_t, 3> corners{};
  std::uint64_t count = 0;  ///< of corners
  std::optional<std::uint64_t> neighbor;
};

Face faceOf(Numbers& numbers, const Element& element) {
  Face face;
  numbers.item(element, [&](const Property& property, std::uint64_t i, std::uint64_t bits) {
    if (property.name == "vertex_indices" || property.name == "vertex_index") {
      if (i < 3) face.corners[i] = bits;
      ++face.count;
    } else if (property.name == "neighbor" || property.name == "facing") {
      face.neighbor = bits;
    }
  });
  return face;
}

}  // namespace

std::vector<std::uint16_t> readNeighbors(const std::filesystem::path& file,
                                         const TriangleMesh& mesh) {
  return neighborFromBytes(readFileBytes(file), mesh);
}

std::vector<std::uint16_t> neighborFromBytes(const std::string& bytes, const TriangleMesh& mesh) {
  std::size_t at = 0;
  const std::optional<std::vector<Element>> elements = readHeader(bytes, at);
  if (!elements) return {};
  Numbers numbers(bytes, at);
  std::vector<Position> positions;
  std::vector<std::uint16_t> neighbor;
  for (const Element& element : *elements) {
    if (element.properties.empty())
      return {};  // its count alone would decide the number of iterations
    for (std::size_t i = 0; i < element.count && numbers.good(); ++i) {
      if (element.name == "vertex") {
        positions.push_back(positionOf(numbers, element));
        continue;
      }
      const Face face = faceOf(numbers, element);
      if (element.name != "face") continue;
      if (face.count != 3 || !face.neighbor || *face.neighbor > 0xffff) return {};
      for (const std::uint64_t corner : face.corners) {
        if (corner >= positions.size()) return {};
      }
      // readMesh drops triangles with two equal corners.
      const Position &a = positions[face.corners[0]], &b = positions[face.corners[1]],
                     &c = positions[face.corners[2]];
      if (a != b && b != c && c != a)
        neighbor.push_back(static_cast<std::uint16_t>(*face.neighbor));
    }
  }
  if (!numbers.good() || neighbor.size() != mesh.triangles.size()) return {};
  return neighbor;
}

}  // namespace sherd
