// One layer of a solid: bodies that are far enough from each other to be cut at once.
#pragma once

#include <sherd/labels.h>
#include <sherd/solid.h>

#include <cstddef>
#include <vector>

#include "remesh/complex.h"

namespace sherd {

/// Returns a solid with the blocks of one layer: other voxels near its own are in the exterior
/// band.  The leaves are those of all layers.
[[nodiscard]] Solid solidOfLayer(const Solid& solid, std::size_t layer);

/// Returns the labels of one layer, 0 in the exterior band.
///   solid  solidOfLayer
[[nodiscard]] Labels labelsOfLayer(const Labels& labels, const Solid& solid);

/// Returns the triangles of one layer, with all vertices.
[[nodiscard]] SolidMesh meshOfLayer(const SolidMesh& mesh, std::size_t layer);

/// Adds the meshes of the fragments of one layer to those of others.
///   layer, all  [fragments]; no mesh is in both
void addLayer(std::vector<LabeledMesh> layer, std::vector<LabeledMesh>& all);

}  // namespace sherd
