// From what a reader found to a mesh.
#include "mesh/merge.h"

#include <array>
#include <bit>
#include <cstdint>

namespace sherd {
namespace {

constexpr std::uint32_t kNone = 0xffffffffu;

// A position by its bits, so that a NaN equals itself and many of them stay cheap; adding 0 turns
// -0 into 0.
using Bits = std::array<std::uint64_t, 3>;

Bits bitsOf(const glm::dvec3& v) {
  return {std::bit_cast<std::uint64_t>(v.x + 0.0), std::bit_cast<std::uint64_t>(v.y + 0.0),
          std::bit_cast<std::uint64_t>(v.z + 0.0)};
}

std::uint64_t hashOf(const Bits& bits) {
  std::uint64_t h = 0;
  for (const std::uint64_t word : bits) {  // splitmix64's mixing
    h = (h ^ word) + 0x9e3779b97f4a7c15u;
    h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9u;
    h = (h ^ (h >> 27)) * 0x94d049bb133111ebu;
    h ^= h >> 31;
  }
  return h;
}

// For each vertex the first one at the same place.
std::vector<std::uint32_t> firstEqual(const std::vector<glm::dvec3>& vertices) {
  const std::size_t slots = std::bit_ceil(2 * vertices.size() + 1);
  std::vector<std::uint32_t> table(slots, kNone);  // open addressing: a vertex per slot
  std::vector<std::uint32_t> first(vertices.size());
  for (std::uint32_t i = 0; i < vertices.size(); ++i) {
    const Bits bits = bitsOf(vertices[i]);
    std::size_t slot = hashOf(bits) & (slots - 1);
    while (table[slot] != kNone && bitsOf(vertices[table[slot]]) != bits)
      slot = (slot + 1) & (slots - 1);
    if (table[slot] == kNone) table[slot] = i;
    first[i] = table[slot];
  }
  return first;
}

template <class Value>
std::array<Value, 3> cornersOf(const glm::uvec3& t, const std::vector<Value>& ofVertex) {
  return {ofVertex[t.x], ofVertex[t.y], ofVertex[t.z]};
}

}  // namespace

Merged mergeVertices(const RawMesh& raw) {
  const std::vector<std::uint32_t> first = firstEqual(raw.vertices);
  Merged out;
  out.mesh.triangles.reserve(raw.triangles.size());
  std::vector<std::uint32_t> number(raw.vertices.size(), kNone);  // in the new mesh
  for (std::size_t i = 0; i < raw.triangles.size(); ++i) {
    const glm::uvec3& t = raw.triangles[i];
    const glm::uvec3 merged(first[t.x], first[t.y], first[t.z]);
    if (merged.x == merged.y || merged.y == merged.z || merged.z == merged.x) {
      ++out.degenerateTriangles;
      continue;
    }
    out.mesh.triangles.push_back(merged);
    for (int k = 0; k < 3; ++k) number[merged[k]] = 0;
    if (!raw.texcoords.empty()) out.look.texcoords.push_back(cornersOf(t, raw.texcoords));
    if (!raw.colours.empty()) out.look.colours.push_back(cornersOf(t, raw.colours));
    if (!raw.material.empty()) out.look.material.push_back(raw.material[i]);
  }
  for (std::size_t i = 0; i < number.size(); ++i) {
    if (number[i] == kNone) continue;
    number[i] = static_cast<std::uint32_t>(out.mesh.vertices.size());
    out.mesh.vertices.push_back(raw.vertices[i]);
  }
  for (glm::uvec3& t : out.mesh.triangles) t = {number[t.x], number[t.y], number[t.z]};
  return out;
}

}  // namespace sherd
