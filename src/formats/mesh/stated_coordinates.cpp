// What files say of their coordinates that Assimp leaves out.
#include "formats/mesh/stated_coordinates.h"

#include <string_view>

#include "base/text/lower_case.h"
#include "formats/arrays/zip_reader.h"

namespace sherd {
namespace {

constexpr std::string_view kSpace = " \t\r\n";

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

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kSpace);
  if (first == text.npos) return {};
  return text.substr(first, text.find_last_not_of(kSpace) - first + 1);
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

// Returns an attribute of the first element with a name, as `unit` of <model unit="inch">.
std::string_view attributeOf(std::string_view xml, const std::string& element,
                             std::string_view attribute) {
  std::size_t begin = xml.find("<" + element);
  if (begin == xml.npos) return {};
  begin += element.size() + 1;
  std::string_view tag = xml.substr(begin, xml.find('>', begin) - begin);
  for (;;) {  // name, =, quoted value
    const std::size_t equals = tag.find('=');
    if (equals == tag.npos) return {};
    const std::string_view name = trimmed(tag.substr(0, equals));
    const std::size_t quote = tag.find_first_of("\"'", equals);
    if (quote == tag.npos) return {};
    const std::size_t end = tag.find(tag[quote], quote + 1);
    if (end == tag.npos) return {};
    if (name == attribute) return trimmed(tag.substr(quote + 1, end - quote - 1));
    tag.remove_prefix(end + 1);
  }
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

// Returns the beginning of the model part of a 3MF file.
std::string modelHead(const MeshFile& file) {
  constexpr std::size_t kHead = std::size_t{1} << 16;  // the root element follows the prolog
  const std::vector<ZipEntry> entries = zipEntries(file.bytes, file.name);
  const ZipEntry* model = nullptr;
  for (const ZipEntry& entry : entries) {
    const std::string name = lowerCase(entry.name);
    if (!name.ends_with(".model")) continue;
    if (model == nullptr || name.ends_with("3d/3dmodel.model")) model = &entry;
  }
  std::string head;
  if (model == nullptr) return head;
  unpack(*model, file.name, [&](std::string_view block) {
    if (head.size() < kHead) head += block.substr(0, kHead - head.size());
  });
  return withoutComments(head);
}

struct NamedUnit {
  std::string_view name;
  double meters;
};
constexpr NamedUnit k3mfUnits[] = {{"micron", 1e-6}, {"millimeter", 1e-3}, {"centimeter", 1e-2},
                                   {"inch", 0.0254}, {"foot", 0.3048},     {"meter", 1.0}};

void setOf3mf(const MeshFile& file, RawMesh& mesh) {
  std::string head;
  try {
    head = modelHead(file);
  } catch (const Error&) {
    return;  // Assimp read what it could of it
  }
  const std::string_view unit = attributeOf(head, "model", "unit");
  for (const NamedUnit& known : k3mfUnits) {
    if (unit == known.name) mesh.metersPerUnit = known.meters;
  }
}

}  // namespace

void setStatedCoordinates(const MeshFile& file, RawMesh& mesh) {
  if (file.format == MeshFormat::dae) setOfCollada(file.bytes, mesh);
  if (file.format == MeshFormat::threeMf) setOf3mf(file, mesh);
}

}  // namespace sherd
