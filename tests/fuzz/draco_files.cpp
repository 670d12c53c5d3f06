// Meshes packed by Draco, and the .glb that holds one.
#include "fuzz/draco_files.h"

#include <cstdint>
#include <nlohmann/json.hpp>

#include "base/little_endian.h"
#include "draco_stream.h"
#include "shapes.h"

namespace sherd::fuzz {

std::vector<std::string> dracoStreams() {
  std::vector<std::string> streams;
  for (const int method : {draco::MESH_SEQUENTIAL_ENCODING, draco::MESH_EDGEBREAKER_ENCODING}) {
    streams.push_back(dracoStream(shapes::cube(1.0), method));
    streams.push_back(dracoStream(shapes::torus(2.0, 1.0, 8, 6), method));
    streams.push_back(streams.back().substr(0, 11));  // its header, and no counts
  }
  return streams;
}

std::vector<std::string> dracoGlbs() {
  std::vector<std::string> files;
  for (const std::string& stream : dracoStreams()) {
    files.push_back(wrappedDraco(stream, DracoPositions::packed));
    files.push_back(wrappedDraco(stream, DracoPositions::plain));
  }
  return files;
}

std::string wrappedDraco(std::string_view stream, DracoPositions positions) {
  using Json = nlohmann::json;
  const bool inside = positions == DracoPositions::packed;
  Json attributes = {{"POSITION", 0}}, unpacked = Json::object();
  if (inside) {
    attributes["COLOR_0"] = 1;
    unpacked = {{"POSITION", kDracoPositions}, {"COLOR_0", kDracoColors}};
  }
  const Json primitive = {
      {"attributes", attributes},
      {"extensions",
       {{"KHR_draco_mesh_compression", {{"bufferView", 0}, {"attributes", unpacked}}}}}};
  const Json json = {
      {"asset", {{"version", "2.0"}}},
      {"nodes", {{{"mesh", 0}}}},
      {"meshes", {{{"primitives", {primitive}}}}},
      {"buffers", {{{"byteLength", stream.size()}}}},
      {"bufferViews", {{{"buffer", 0}, {"byteLength", stream.size()}}}},
      {"accessors",
       {{{"componentType", 5126}, {"count", 3}, {"type", "VEC3"}},
        {{"componentType", 5121}, {"count", 3}, {"type", "VEC4"}, {"normalized", true}}}}};
  std::string text = json.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  std::string file = "glTF";
  storeLittle(file, std::uint32_t{2});
  storeLittle(file, static_cast<std::uint32_t>(28 + text.size() + stream.size()));
  storeLittle(file, static_cast<std::uint32_t>(text.size()));
  file += "JSON" + text;
  storeLittle(file, static_cast<std::uint32_t>(stream.size()));
  return file.append("BIN\0", 4).append(stream);
}

}  // namespace sherd::fuzz
