// What files say of their coordinates that Assimp leaves out.
#include "formats/mesh_files/stated_coordinates.h"

#include <string>
#include <string_view>

#include "base/text/text_scan.h"

namespace sherd {
namespace {

std::string withoutComments(std::string_view xml) {
  std::string text;
  for (;;) {
    const std::size_t open = xml.find("<!--");
    text += xml.substr(0, open);
    if (open == xml.npos) return text;
    const std::size_t close = xml.find("-->", open + 4);
    if (close == xml.npos) return text;
    xml.remove_prefix(close + 3);
  }
}

// Returns what is within the first element with a name, which has neither attributes nor children.
std::string_view contentOf(std::string_view xml, const std::string& element) {
  const std::string open = "<" + element + ">", close = "</" + element;
  const std::size_t begin = xml.find(open);
  if (begin == xml.npos) return {};
  const std::size_t end = xml.find(close, begin);
  if (end == xml.npos) return {};
  return trimmed(xml.substr(begin + open.size(), end - begin - open.size()));
}

// Of <up_axis>Z_UP</up_axis> in the file's first <asset>; its specification has y where it is
// absent, which is as good as assumed.
void setOfCollada(std::string_view bytes, RawMesh& mesh) {
  mesh.metersPerUnit = 1.0;
  const std::string head = withoutComments(bytes.substr(0, bytes.find("</asset>")));
  const std::string_view axis = contentOf(head, "up_axis");
  if (axis == "X_UP") mesh.up = 'x';
  if (axis == "Y_UP") mesh.up = 'y';
  if (axis == "Z_UP") mesh.up = 'z';
}

}  // namespace

void setStatedCoordinates(const MeshFile& file, RawMesh& mesh) {
  if (file.format == MeshFormat::dae) setOfCollada(file.bytes, mesh);
}

}  // namespace sherd
