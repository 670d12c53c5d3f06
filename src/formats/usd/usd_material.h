// Materials of a USD scene.
#pragma once

#include <cstdint>
#include <string>

#include "formats/mesh/piece_mesh.h"
#include "formats/usd/usd_text.h"

namespace sherd {

/// Writes a material as UsdPreviewSurface, with its textures that are PNG or
/// JPEG.
///   path           of the prim, which is named like its end
///   textureFolder  see FragmentScene::textureFolder
void writeUsdMaterial(UsdText& text, const std::string& path, const MaterialTable& table,
                      std::uint32_t number, const SurfaceAttributes& attributes,
                      const std::string& textureFolder);

}  // namespace sherd
