// Loops of crossed edges.
#include "interface/cells/cell.h"

#include <algorithm>
#include <vector>

namespace sherd {
namespace {

using Links = std::array<std::uint8_t, 12>;  // union-find over the cell's edges

std::uint8_t rootOf(const Links& links, std::uint8_t edge) {
  while (links[edge] != edge) edge = links[edge];
  return edge;
}

void link(Links& links, std::uint8_t a, std::uint8_t b) {
  a = rootOf(links, a);
  b = rootOf(links, b);
  links[std::max(a, b)] = std::min(a, b);
}

Links unlinked() {
  Links links;
  for (std::uint8_t e = 0; e < 12; ++e) links[e] = e;
  return links;
}

std::uint8_t edgeBetween(unsigned a, unsigned b) {
  const unsigned low = std::min(a, b), high = std::max(a, b);
  for (std::uint8_t e = 0; e < 12; ++e) {
    if (kCellEdges[e][0] == low && kCellEdges[e][1] == high) return e;
  }
  return CellSheets::kNone;
}

// Corners of a face in cyclic order, and the edge from each to the next.
struct Face {
  std::array<std::uint8_t, 4> corner, edge;
};

const std::array<Face, kCellFaces>& faces() {
  static const std::array<Face, kCellFaces> all = [] {
    std::array<Face, kCellFaces> made;
    for (unsigned f = 0; f < kCellFaces; ++f) {
      const unsigned across = 4u >> (f / 2);
      const unsigned u = f / 2 == 0 ? 2 : 4, v = f / 2 == 2 ? 2 : 1;
      const unsigned base = f % 2 ? across : 0;
      const std::array<unsigned, 4> ring{base, base + u, base + u + v, base + v};
      for (unsigned k = 0; k < 4; ++k) {
        made[f].corner[k] = static_cast<std::uint8_t>(ring[k]);
        made[f].edge[k] = edgeBetween(ring[k], ring[(k + 1) % 4]);
      }
    }
    return made;
  }();
  return all;
}

// True if `label`'s corners are separated on a face on which two labels alternate.
bool isSeparated(std::uint16_t label, std::uint16_t other) {
  return static_cast<std::uint16_t>(label - 1) < static_cast<std::uint16_t>(other - 1);
}

// Links the edges of a face that are consecutive on the label's boundary.  Returns true if the face
// is ambiguous for the label.
bool linkFace(const CellLabels& labels, const Face& face, std::uint16_t label, bool isFlipped,
              Links& links) {
  std::array<bool, 4> own;
  unsigned count = 0;
  for (unsigned k = 0; k < 4; ++k) {
    own[k] = labels[face.corner[k]] == label;
    count += own[k];
  }
  if (count == 0 || count == 4) return false;
  if (count == 2 && own[0] == own[2]) {
    const unsigned ownCorner = own[0] ? 0 : 1;  // the first corner of the label
    const std::uint16_t one = labels[face.corner[ownCorner + 1]],
                        two = labels[face.corner[(ownCorner + 3) % 4]];
    const bool separated = (one == two && isSeparated(label, one)) != isFlipped;
    const unsigned start =
        separated ? ownCorner : ownCorner + 1;  // a corner whose two edges are linked
    link(links, face.edge[(start + 3) % 4], face.edge[start % 4]);
    link(links, face.edge[(start + 1) % 4], face.edge[(start + 2) % 4]);
    return true;
  }
  std::uint8_t first = CellSheets::kNone;
  for (unsigned k = 0; k < 4; ++k) {
    if (own[k] == own[(k + 1) % 4]) continue;
    if (first == CellSheets::kNone) {
      first = face.edge[k];
    } else {
      link(links, first, face.edge[k]);
    }
  }
  return false;
}

// True if a face is ambiguous for the label.  Few labels have one, so most return early.
bool hasAmbiguousFace(const CellLabels& labels, std::uint16_t label) {
  return std::any_of(faces().begin(), faces().end(), [&](const Face& face) {
    const bool a = labels[face.corner[0]] == label, b = labels[face.corner[1]] == label;
    return a != b && (labels[face.corner[2]] == label) == a &&
           (labels[face.corner[3]] == label) == b;
  });
}

}  // namespace

unsigned conflictingFaces(const CellLabels& labels, std::uint16_t label, unsigned flipped) {
  if (!hasAmbiguousFace(labels, label)) return 0;
  Links links = unlinked();
  unsigned ambiguous = 0, conflicting = 0;
  for (unsigned f = 0; f < kCellFaces; ++f) {
    if (linkFace(labels, faces()[f], label, (flipped >> f) & 1, links)) ambiguous |= 1u << f;
  }
  for (unsigned f = 0; f < kCellFaces; ++f) {
    if (!((ambiguous >> f) & 1)) continue;
    const auto& edge = faces()[f].edge;
    const std::uint8_t root = rootOf(links, edge[0]);
    if (std::all_of(edge.begin(), edge.end(),
                    [&](std::uint8_t e) { return rootOf(links, e) == root; })) {
      conflicting |= 1u << f;
    }
  }
  return conflicting;
}

CellSheets sheetsOf(const CellLabels& labels, const std::array<std::uint8_t, 8>& flipped) {
  CellSheets sheets;
  for (auto& loops : sheets.loopOf) loops.fill(CellSheets::kNone);
  sheets.positionOf.fill(CellSheets::kNone);
  Links positionLinks = unlinked();
  for (std::size_t corner = 0; corner < 8; ++corner) {
    const std::uint16_t label = labels[corner];
    const auto end = labels.begin() + static_cast<std::ptrdiff_t>(corner);
    if (label == 0 || std::find(labels.begin(), end, label) != end) continue;
    Links links = unlinked();
    for (unsigned f = 0; f < kCellFaces; ++f) {
      (void)linkFace(labels, faces()[f], label, (flipped[corner] >> f) & 1, links);
    }
    std::array<std::uint8_t, 12> loop;
    loop.fill(CellSheets::kNone);
    for (std::uint8_t e = 0; e < 12; ++e) {
      const std::uint16_t low = labels[kCellEdges[e][0]], high = labels[kCellEdges[e][1]];
      if (low == high || (low != label && high != label)) continue;
      const std::uint8_t root = rootOf(links, e);
      link(positionLinks, e, root);
      if (loop[root] == CellSheets::kNone) loop[root] = sheets.loops++;
      sheets.loopOf[e][low == label ? 0 : 1] = loop[root];
    }
  }
  std::array<std::uint8_t, 12> position;
  position.fill(CellSheets::kNone);
  for (std::uint8_t e = 0; e < 12; ++e) {
    if (labels[kCellEdges[e][0]] == labels[kCellEdges[e][1]]) continue;
    const std::uint8_t root = rootOf(positionLinks, e);
    if (position[root] == CellSheets::kNone) position[root] = sheets.positions++;
    sheets.positionOf[e] = position[root];
    for (const std::uint8_t loop : sheets.loopOf[e]) {
      if (loop != CellSheets::kNone) sheets.positionOfLoop[loop] = position[root];
    }
  }
  return sheets;
}

namespace {

// The sheets of cells with at most two labels and 0.  They depend on the order of the labels only,
// of which 0 is the highest: a cell's number has a digit 0 to 2 for each corner, base 3.
class PlainSheets {
 public:
  static constexpr std::size_t kCells = 6561;  // 3^8

  PlainSheets() : sheets_(kCells), isPlain_(kCells) {
    constexpr std::array<std::uint16_t, 3> kLabelOf{1, 2, 0};
    for (std::size_t cell = 0; cell < kCells; ++cell) {
      CellLabels labels;
      std::size_t rest = cell;
      for (std::uint16_t& label : labels) {
        label = kLabelOf[rest % 3];
        rest /= 3;
      }
      isPlain_[cell] = !hasAmbiguousFace(labels, 1) && !hasAmbiguousFace(labels, 2);
      if (isPlain_[cell]) sheets_[cell] = sheetsOf(labels);
    }
  }

  const CellSheets* of(std::size_t cell) const { return isPlain_[cell] ? &sheets_[cell] : nullptr; }

 private:
  std::vector<CellSheets> sheets_;
  std::vector<bool> isPlain_;
};

}  // namespace

const CellSheets* plainSheetsOf(const CellLabels& labels) {
  static const PlainSheets all;
  std::uint16_t low = 0xffff, high = 0;
  for (const std::uint16_t label : labels) {
    if (label == 0) continue;
    low = std::min(low, label);
    high = std::max(high, label);
  }
  std::size_t cell = 0, digit = 1;
  for (const std::uint16_t label : labels) {
    if (label != 0 && label != low && label != high) return nullptr;
    cell += digit * (label == 0 ? 2u : label == low ? 0u : 1u);
    digit *= 3;
  }
  return all.of(cell);
}

}  // namespace sherd
