// Contact boundaries as OBJ polylines.
#include <sherd/folder.h>

#include <cstdio>

#include "base/text/number_text.h"

namespace sherd {

void writeBoundaries(const OutputFile& file, std::span<const Fragment> fragments, bool isDouble) {
  std::string text;
  std::size_t vertices = 0;
  for (const Fragment& fragment : fragments) {
    const auto curves = boundaryLoops(fragment);
    for (const Contact& contact : fragment.contacts) {
      if (contact.fragment < fragment.id) continue;
      char name[32];
      std::snprintf(name, sizeof name, "o boundary_%03d_%03d\n", fragment.id, contact.fragment);
      text += name;
      const auto found = curves.find(contact.fragment);
      if (found == curves.end()) continue;
      for (const std::vector<std::uint32_t>& curve : found->second) {
        for (const std::uint32_t v : curve) {
          appendVector(text += 'v', fragment.mesh.vertices[v], isDouble);
          text += '\n';
        }
        text += 'l';
        for (std::size_t i = 1; i <= curve.size(); ++i) appendShortest(text += ' ', vertices + i);
        appendShortest(text += ' ', vertices + 1);
        text += '\n';
        vertices += curve.size();
      }
    }
  }
  file.write(text);
}

}  // namespace sherd
