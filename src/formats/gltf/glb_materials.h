// The materials of a glTF file that is written.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "formats/gltf/glb_file.h"
#include "formats/mesh/piece_mesh.h"

namespace sherd {

/// Adds materials and textures to a file, each once. The meshes of a file share their table, and
/// have all colors, and all texture coordinates, or none.
class GlbMaterials {
 public:
  GlbMaterials(GlbFile& file, const MaterialTable& table)
      : file_(file),
        table_(table),
        numbers_(table.materials.size(), -1),
        imageNumbers_(table.textures.size(), -1) {}

  /// Returns the number in the file of a material of the table.
  std::size_t numberOf(std::uint32_t material, const SurfaceAttributes& attributes);

 private:
  using Json = GlbFile::Json;

  Json jsonOf(std::uint32_t material, const SurfaceAttributes& attributes);
  Json plainJson(std::uint32_t material, const SurfaceAttributes& attributes);
  bool placeTexture(Json& use);
  int textureNumber(int image, const Json& sampler);
  void noteExtensions(const Json& object);

  GlbFile& file_;
  const MaterialTable& table_;
  std::vector<int> numbers_, imageNumbers_;                      // -1: not written yet
  std::map<std::string, std::size_t> samplers_;                  // by JSON
  std::map<std::pair<int, std::string>, std::size_t> textures_;  // by image and sampler
};

}  // namespace sherd
