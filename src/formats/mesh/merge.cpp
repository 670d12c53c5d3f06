// Turns a reader's result into a mesh.
#include "formats/mesh/merge.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>

#include "base/finite.h"

namespace sherd {
namespace {

constexpr std::uint32_t kUnnumbered = 0xffffffffu;

// The bits of a position: NaNs equal themselves, so many of them stay cheap; adding 0 turns -0 into
// 0.
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

std::size_t slotsFor(std::size_t vertices) { return std::bit_ceil(2 * vertices + 1); }

// Returns for each vertex the first one at the same position.
std::vector<std::uint32_t> firstEqual(const std::vector<glm::dvec3>& vertices) {
  const std::size_t slots = slotsFor(vertices.size());
  std::vector<std::uint32_t> table(slots, kUnnumbered);  // open addressing: a vertex per slot
  std::vector<std::uint32_t> first(vertices.size());
  // The table is larger than the caches: a block's slots are prefetched together.
  constexpr std::size_t kBlock = 32;
  std::array<std::size_t, kBlock> slotOf{};
  for (std::size_t begin = 0; begin < vertices.size(); begin += kBlock) {
    const std::size_t end = std::min(begin + kBlock, vertices.size());
    for (std::size_t i = begin; i < end; ++i) {
      slotOf[i - begin] = hashOf(bitsOf(vertices[i])) & (slots - 1);
      __builtin_prefetch(&table[slotOf[i - begin]]);
    }
    for (std::size_t i = begin; i < end; ++i) {
      const Bits bits = bitsOf(vertices[i]);
      std::size_t slot = slotOf[i - begin];
      while (table[slot] != kUnnumbered && bitsOf(vertices[table[slot]]) != bits)
        slot = (slot + 1) & (slots - 1);
      if (table[slot] == kUnnumbered) table[slot] = static_cast<std::uint32_t>(i);
      first[i] = table[slot];
    }
  }
  return first;
}

// Returns the triangles whose corners are all finite; counts the dropped ones in `out`.
std::vector<std::uint32_t> finiteTriangles(const RawMesh& raw, SourceMesh& out) {
  std::vector<std::uint32_t> kept(raw.triangles.size());
  std::iota(kept.begin(), kept.end(), 0u);
  if (areFinite(raw.vertices)) return kept;
  kept.clear();
  std::vector<bool> counted;
  for (std::uint32_t i = 0; i < raw.triangles.size(); ++i) {
    const glm::uvec3& t = raw.triangles[i];
    bool finite = true;
    for (int k = 0; k < 3; ++k) {
      if (isFinite(raw.vertices[t[k]])) continue;
      finite = false;
      counted.resize(raw.vertices.size());
      out.droppedVertices += !counted[t[k]];
      counted[t[k]] = true;
    }
    if (finite) kept.push_back(i);
  }
  out.droppedTriangles = raw.triangles.size() - kept.size();
  return kept;
}

// Returns the values of the kept triangles; `values` has one per triangle or is empty.
template <class Value>
std::vector<Value> only(std::vector<Value>&& values, const std::vector<std::uint32_t>& kept) {
  if (values.size() <= kept.size()) return std::move(values);
  for (std::size_t i = 0; i < kept.size(); ++i) values[i] = values[kept[i]];
  values.resize(kept.size());
  return std::move(values);
}

// Sets the faces of the kept triangles.
void setPolygons(RawMesh& raw, const std::vector<std::uint32_t>& kept, MemoryBudget* memory,
                 SourceMesh& out) {
  if (!raw.polygons.empty() || kept.size() == raw.triangles.size()) {
    out.polygons = only(std::move(raw.polygons), kept);
    return;
  }
  if (memory != nullptr) memory->charge(kept.size(), sizeof(PolygonPart));
  out.polygons.reserve(kept.size());
  for (const std::uint32_t i : kept) out.polygons.push_back({i, {0, 1, 2}});
}

// Keeps the objects that have a triangle; a single one is the mesh itself.
void setObjects(RawMesh&& raw, SourceMesh& out) {
  std::vector<std::uint32_t> number(raw.objects.size(), kUnnumbered);
  for (const std::uint32_t object : raw.objectOfTriangle) number[object] = 0;
  for (std::size_t i = 0; i < number.size(); ++i) {
    if (number[i] == kUnnumbered) continue;
    number[i] = static_cast<std::uint32_t>(out.objects.size());
    out.objects.push_back(std::move(raw.objects[i]));
  }
  if (out.objects.size() < 2) {
    out.objects.clear();
    return;
  }
  out.objectOfTriangle = std::move(raw.objectOfTriangle);
  for (std::uint32_t& object : out.objectOfTriangle) object = number[object];
}

}  // namespace

std::uint64_t mergingMemory(const RawMesh& raw) {
  // The table; for each vertex its first equal and its new number; the kept triangles.
  const std::uint64_t numbers =
      slotsFor(raw.vertices.size()) + 2 * raw.vertices.size() + raw.triangles.size();
  return sizeof(std::uint32_t) * numbers;
}

SourceMesh mergeVertices(RawMesh&& raw, MemoryBudget* memory) {
  SourceMesh out;
  out.fileVertices = raw.vertices.size();
  std::vector<std::uint32_t> kept = finiteTriangles(raw, out);
  const std::vector<std::uint32_t> first = firstEqual(raw.vertices);
  const std::size_t finite = kept.size();
  std::vector<std::uint32_t> number(raw.vertices.size(), kUnnumbered);  // in the new mesh
  std::erase_if(kept, [&](std::uint32_t i) {
    glm::uvec3& t = raw.triangles[i];
    t = {first[t.x], first[t.y], first[t.z]};
    if (t.x == t.y || t.y == t.z || t.z == t.x) return true;
    for (int k = 0; k < 3; ++k) number[t[k]] = 0;
    return false;
  });
  out.degenerateTriangles = finite - kept.size();

  std::uint32_t used = 0;
  for (std::size_t i = 0; i < number.size(); ++i) {
    if (number[i] == kUnnumbered) continue;
    raw.vertices[used] = raw.vertices[i];
    number[i] = used++;
  }
  raw.vertices.resize(used);
  raw.vertices.shrink_to_fit();
  out.mesh.vertices = std::move(raw.vertices);
  setPolygons(raw, kept, memory, out);
  out.mesh.triangles = only(std::move(raw.triangles), kept);
  for (glm::uvec3& t : out.mesh.triangles) t = {number[t.x], number[t.y], number[t.z]};

  out.appearance = std::move(raw.appearance);
  out.mesh.neighbor = only(std::move(raw.neighbor), kept);
  out.mesh.attributes = {only(std::move(raw.attributes.texcoords), kept),
                         only(std::move(raw.attributes.colors), kept),
                         only(std::move(raw.attributes.material), kept),
                         only(std::move(raw.attributes.normals), kept)};
  raw.objectOfTriangle = only(std::move(raw.objectOfTriangle), kept);
  setObjects(std::move(raw), out);
  out.warnings = std::move(raw.warnings);
  return out;
}

}  // namespace sherd
