// The structuring elements of erosion.
#include "erode/shape.h"

#include <algorithm>

namespace sherd {
namespace {

bool contains(ErodeShape shape, int reach, int x, int y, int z) {
  switch (shape) {
    case ErodeShape::cross:
      return (x != 0) + (y != 0) + (z != 0) <= 1;
    case ErodeShape::square:
      return true;
    case ErodeShape::ellipse:
      return x * x + y * y + z * z <= reach * reach;
  }
  return false;
}

// reachX, reachY or reachZ is 0 along the normal of a section.
Shape shapeWithin(ErodeShape shape, int reach, int reachX, int reachY, int reachZ) {
  Shape result;
  for (int x = -reachX; x <= reachX; ++x) {
    for (int y = -reachY; y <= reachY; ++y) {
      if (!contains(shape, reach, x, y, 0)) continue;
      int half = reachZ;
      while (!contains(shape, reach, x, y, half)) --half;
      result.rows.push_back({x, y, half});
      result.cells += 2 * half + 1;
    }
  }
  std::stable_sort(result.rows.begin(), result.rows.end(),
                   [](const ShapeRow& a, const ShapeRow& b) {
                     return a.x * a.x + a.y * a.y < b.x * b.x + b.y * b.y;
                   });
  return result;
}

}  // namespace

std::vector<Shape> shapesOf(ErodeShape shape, int reach, bool planes) {
  if (!planes) return {shapeWithin(shape, reach, reach, reach, reach)};
  return {shapeWithin(shape, reach, 0, reach, reach), shapeWithin(shape, reach, reach, 0, reach),
          shapeWithin(shape, reach, reach, reach, 0)};
}

}  // namespace sherd
