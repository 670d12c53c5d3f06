// Convex hulls of fragments, for simulations.
#include <sherd/folder.h>

#include "base/text/number_text.h"
#include "mesh/hull.h"

namespace sherd {

void writeProxy(const OutputFile& file, const Fragment& fragment, const std::string& name,
                double gap, bool isDouble) {
  const TriangleMesh hull = convexHullMesh(fragment.mesh.vertices, 0.5 * gap);
  std::string text = "o " + name + "\n";
  for (const glm::dvec3& v : hull.vertices) {
    appendVector(text += 'v', v, isDouble);
    text += '\n';
  }
  for (const glm::uvec3& t : hull.triangles) {
    text += 'f';
    for (int k = 0; k < 3; ++k) appendShortest(text += ' ', t[k] + 1);
    text += '\n';
  }
  file.write(text);
}

}  // namespace sherd
