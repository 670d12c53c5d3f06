// The paper's binary mesh, `.binm`.
#include "formats/mesh_files/read_binm.h"

#include <bit>
#include <string_view>

#include "base/little_endian.h"

namespace sherd {
namespace {

constexpr std::size_t kVertexBytes = 64, kFaceBytes = 16;

struct Part {
  std::string_view vertices, faces;
};

/// Takes a count and that many records off the front; false if they go beyond the end.
bool takeRecords(std::string_view& rest, std::size_t countBytes, std::size_t recordBytes,
                 std::string_view& records) {
  if (rest.size() < countBytes) return false;
  const std::uint64_t count = countBytes == 4 ? loadLittle<std::uint32_t>(rest.data())
                                              : loadLittle<std::uint64_t>(rest.data());
  rest.remove_prefix(countBytes);
  if (count > rest.size() / recordBytes) return false;
  records = rest.substr(0, count * recordBytes);
  rest.remove_prefix(records.size());
  return true;
}

// Returns the parts if they fill the file to its end, else none.
std::vector<Part> partsBy(std::string_view rest, std::size_t countBytes, bool hasPartCount) {
  std::uint64_t count = 1;
  if (hasPartCount) {
    if (rest.size() < 8) return {};
    count = loadLittle<std::uint64_t>(rest.data());
    rest.remove_prefix(8);
  }
  std::vector<Part> parts;
  for (std::uint64_t i = 0; i < count; ++i) {
    Part part;
    if (!takeRecords(rest, countBytes, kVertexBytes, part.vertices) ||
        !takeRecords(rest, countBytes, kFaceBytes, part.faces)) {
      return {};
    }
    parts.push_back(part);
  }
  return rest.empty() ? parts : std::vector<Part>();
}

std::vector<Part> partsOf(const MeshFile& file) {
  std::vector<Part> parts = partsBy(file.bytes, 4, false);
  if (parts.empty()) parts = partsBy(file.bytes, 8, false);
  if (parts.empty()) parts = partsBy(file.bytes, 8, true);
  return parts;
}

std::uint32_t cornerAt(const Part& part, std::size_t face, std::size_t corner) {
  return loadLittle<std::uint32_t>(part.faces.data() + kFaceBytes * face + 4 * corner);
}

}  // namespace

RawMesh readBinm(const MeshFile& file) {
  const std::vector<Part> parts = partsOf(file);
  if (parts.empty()) {
    throw inputError(file, "is cut short, or no .binm: its counts do not add up to its " +
                               std::to_string(file.bytes.size()) + " bytes");
  }
  RawMesh raw;
  GrowingMemory memory(file.memory);
  for (const Part& part : parts) {
    const auto first = static_cast<std::uint32_t>(raw.vertices.size());
    const std::size_t count = part.vertices.size() / kVertexBytes;
    const std::size_t faces = part.faces.size() / kFaceBytes;
    checkpoint(file);
    memory.hold((raw.vertices.size() + count) * sizeof(glm::dvec3) +
                (raw.triangles.size() + faces) * sizeof(glm::uvec3));
    for (std::size_t at = 0; at < part.vertices.size(); at += kVertexBytes) {
      glm::dvec3& v = raw.vertices.emplace_back();
      for (int axis = 0; axis < 3; ++axis) {
        v[axis] = std::bit_cast<float>(loadLittle<std::uint32_t>(
            part.vertices.data() + at + 4 * static_cast<std::size_t>(axis)));
      }
    }
    for (std::size_t i = 0; i < faces; ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        if (cornerAt(part, i, k) < count) continue;
        throw inputError(file, "face " + std::to_string(raw.triangles.size() + 1) +
                                   " uses vertex " + std::to_string(cornerAt(part, i, k)) +
                                   ", its part has " + std::to_string(count));
      }
      raw.triangles.emplace_back(first + cornerAt(part, i, 0), first + cornerAt(part, i, 1),
                                 first + cornerAt(part, i, 2));
    }
  }
  return raw;
}

}  // namespace sherd
