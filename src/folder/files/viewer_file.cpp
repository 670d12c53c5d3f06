// viewer.html of a fracture that is being written.
#include "folder/files/viewer_file.h"

#include <algorithm>

#include "folder/manifest/split_parents.h"
#include "mesh/coordinate_system.h"
#include "viewer/page.h"

namespace sherd {
namespace {

ViewerPiece pieceOf(const Fragment& fragment, const FractureResult& result) {
  const glm::dmat3& m = fragment.mass.inertia;
  ViewerPiece piece;
  piece.id = fragment.id;
  piece.mesh = &fragment.mesh;
  piece.voxels = fragment.voxels;
  piece.volume = fragment.mass.volume;
  piece.share = static_cast<double>(fragment.voxels) / static_cast<double>(result.solid.voxels);
  piece.area = fragment.area;
  piece.fractureArea = fragment.fractureArea;
  piece.centroid = fragment.mass.centroid;
  piece.inertia = {m[0][0], m[1][1], m[2][2], m[1][0], m[2][0], m[2][1]};
  for (const Contact& contact : fragment.contacts) {
    piece.contacts.push_back({contact.fragment, contact.area});
  }
  return piece;
}

std::vector<ViewerScene::Material> materialsOf(const MaterialTable& table) {
  std::vector<ViewerScene::Material> materials;
  for (std::uint32_t i = 0; i < table.materials.size(); ++i) {
    const MaterialTable::Entry& entry = table.materials[i];
    if (i == table.inside()) {
      materials.push_back({kInsideColor, -1, true});
    } else {
      materials.push_back({srgbFromLinear(entry.color), entry.texture, false});
    }
  }
  return materials;
}

}  // namespace

void setCoordinates(ViewerScene& scene, const CoordinateSystem& coordinates, double density) {
  const LengthUnit* const unit = unitOf(coordinates.metersPerUnit);
  scene.unit = unit != nullptr ? unit->name : "";
  scene.up = coordinates.up;
  const double meters = coordinates.metersPerUnit;
  scene.density = density * meters * meters * meters;
}

std::vector<std::string> writeViewer(const OutputFile& file, const FractureWriter& writer,
                                     const FractureResult& result,
                                     std::span<const SurfaceAttributes> attributes,
                                     std::uint64_t maxBytes, const Progress* progress) {
  ViewerScene scene;
  scene.title = writer.source().name;
  setCoordinates(scene, writer.coordinates(), writer.options().density);
  scene.materials = materialsOf(writer.materials());
  for (std::size_t i = 0; i < writer.materials().baseColorTextures(); ++i) {
    const MaterialTable::Image& image = writer.materials().textures[i];
    scene.textures.push_back({image.file, image.bytes});
  }
  const SplitParents parents = parentsOf(result.labels.splits, result.fragments.size());
  for (const std::size_t parent : parents.ofSplit) {
    scene.splitParents.push_back(static_cast<int>(parent));
  }
  for (std::size_t i = 0; i < result.fragments.size(); ++i) {
    ViewerPiece piece = pieceOf(result.fragments[i], result);
    piece.split = static_cast<int>(parents.ofFragment[i]);
    piece.isMissing = i >= result.kept();
    if (i < attributes.size()) piece.attributes = &attributes[i];
    scene.pieces.push_back(std::move(piece));
  }
  ViewerPage page = viewerPage(scene, maxBytes, progress);
  file.write(page.html);
  for (std::string& warning : page.warnings) warning = "viewer.html: " + warning;
  return std::move(page.warnings);
}

}  // namespace sherd
