// A binary glTF 2.0 file in the making.
#include "formats/gltf/glb_file.h"

#include <sherd/error.h>

#include <cstdint>
#include <limits>
#include <utility>

#include "base/little_endian.h"
#include "base/version.h"
#include "formats/gltf/gltf_root.h"

namespace sherd {
namespace {

void addChunk(const ByteSink& sink, const char* type, const std::string& content) {
  std::string head;
  storeLittle(head, static_cast<std::uint32_t>(content.size()));
  sink(head.append(type, 4));
  sink(content);
}

}  // namespace

std::size_t GlbFile::end(int target, int stride) {
  Json view = {{"buffer", 0}, {"byteOffset", from_}, {"byteLength", bytes.size() - from_}};
  if (stride != 0) view["byteStride"] = stride;
  if (target != kGltfNoTarget) view["target"] = target;
  bytes.resize((bytes.size() + 3) / 4 * 4, '\0');
  views.push_back(std::move(view));
  return views.size() - 1;
}

std::size_t GlbFile::accessor(std::size_t view, int componentType, std::size_t count,
                              const char* type) {
  accessors.push_back(
      {{"bufferView", view}, {"componentType", componentType}, {"count", count}, {"type", type}});
  return accessors.size() - 1;
}

GlbFile::Json GlbFile::document(const std::vector<std::size_t>& roots) {
  Json json = {{"asset", {{"version", "2.0"}, {"generator", "Sherd " SHERD_VERSION}}}};
  json["asset"].update(asset_);
  if (!extensionsUsed.empty()) json["extensionsUsed"] = extensionsUsed;
  if (!extensions.empty()) json["extensions"] = std::move(extensions);
  json["scene"] = 0;
  json["scenes"] = Json::array({{{"nodes", roots}}});
  const auto add = [&json](const char* name, Json& array) {
    if (!array.empty()) json[name] = std::move(array);
  };
  add("nodes", nodes);
  add("meshes", meshes);
  add("materials", materials);
  add("textures", textures);
  add("samplers", samplers);
  add("images", images);
  add("accessors", accessors);
  add("bufferViews", views);
  json["buffers"] = Json::array({{{"byteLength", bytes.size()}}});
  return json;
}

void GlbFile::write(const OutputFile& file, std::vector<std::size_t> roots,
                    const CoordinateSystem& coordinates, const std::string& name) {
  if (!isOfGltf(coordinates)) {
    Json root = {{"name", name}, {"children", roots}};
    root.update(rootTransform(coordinates));
    asset_ = {{"extras", assetExtras(coordinates)}};
    roots = {nodes.size()};
    nodes.push_back(std::move(root));
  }
  std::string text = document(roots).dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  const std::size_t length = 12 + 8 + text.size() + 8 + bytes.size();
  if (length > std::numeric_limits<std::uint32_t>::max()) {
    throw Error(ErrorCode::output, file.string() + ": would have " + std::to_string(length) +
                                       " bytes; binary glTF holds less than 2^32");
  }
  file.write([&](const ByteSink& sink) {
    std::string head = "glTF";
    storeLittle(head, std::uint32_t{2});
    storeLittle(head, static_cast<std::uint32_t>(length));
    sink(head);
    addChunk(sink, "JSON", text);
    addChunk(sink, "BIN\0", bytes);
  });
}

}  // namespace sherd
