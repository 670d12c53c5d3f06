// A triangulation of a triangle as half edges.
#include "intersect/half_edges.h"

#include <algorithm>

namespace sherd {

HalfEdges::HalfEdges(std::size_t points) : from_(points, kNone) {
  // Euler: a triangulation of n points has fewer than 3n edges.
  origin_.reserve(6 * points);
  next_.reserve(6 * points);
  segment_.reserve(3 * points);
  makeTriangle(addEdge(0, 1), addEdge(1, 2), addEdge(2, 0));
}

HalfEdges::Index HalfEdges::addEdge(Index origin, Index target) {
  const auto h = static_cast<Index>(next_.size());
  origin_.insert(origin_.end(), {origin, target});
  next_.insert(next_.end(), {kNone, kNone});
  segment_.push_back(kNone);
  return h;
}

void HalfEdges::makeTriangle(Index a, Index b, Index c) {
  next_[a] = b;
  next_[b] = c;
  next_[c] = a;
  for (const Index h : {a, b, c}) from_[origin_[h]] = h;
}

std::vector<HalfEdges::Index> HalfEdges::around(Index point) const {
  // Clockwise to the boundary, or once around.
  const Index first = from(point);
  Index start = first;
  while (!isOuter(twin(start))) {
    start = next(twin(start));
    if (start == first) break;
  }
  std::vector<Index> found;
  Index h = start;
  do {
    found.push_back(h);
    h = twin(after(h));
  } while (!isOuter(h) && h != start);
  return found;
}

void HalfEdges::splitTriangle(Index h, Index point) {
  const Index h1 = next(h), h2 = after(h);
  const Index a = addEdge(origin(h), point), b = addEdge(origin(h1), point),
              c = addEdge(origin(h2), point);
  makeTriangle(h, b, twin(a));
  makeTriangle(h1, c, twin(b));
  makeTriangle(h2, a, twin(c));
}

//          c                   c
//        /   \               / | \             .
//      a --h-> b    =>     a-h-p---b
//        \   /               \ | /
//          d                   d
void HalfEdges::splitEdge(Index h, Index point) {
  if (isOuter(h)) h = twin(h);
  const Index g = twin(h), h1 = next(h), h2 = after(h);
  const bool isInner = !isOuter(g);
  const Index g1 = isInner ? next(g) : kNone, g2 = isInner ? after(g) : kNone;
  const Index rest = addEdge(point, target(h)), up = addEdge(point, origin(h2));
  origin_[g] = point;
  makeTriangle(h, up, h2);
  makeTriangle(rest, h1, twin(up));
  if (!isInner) return;
  const Index down = addEdge(point, origin(g2));
  makeTriangle(g, g1, twin(down));
  makeTriangle(twin(rest), down, g2);
}

void HalfEdges::flip(Index h) {
  const Index g = twin(h), h1 = next(h), h2 = after(h), g1 = next(g), g2 = after(g);
  origin_[h] = origin_[g2];
  origin_[g] = origin_[h2];
  makeTriangle(h, h2, g1);
  makeTriangle(g, g2, h1);
}

}  // namespace sherd
