// Pieces in Houdini's geometry, `.geo`.
#pragma once

#include <sherd/files.h>
#include <sherd/progress.h>

#include <span>
#include <string>

#include "formats/mesh/piece_mesh.h"

namespace sherd {

/// A fragment of a file of Houdini's geometry.
struct GeoPiece {
  int id = 0;
  PieceMesh piece;
  int level = 1;     ///< in Unreal's hierarchy of clusters, below its root
  int cluster = -1;  ///< of pieces at this level that Unreal moves as one until it breaks; -1: none
};

/// Returns the attribute `name` of a fragment, by which Houdini identifies its polygons.
[[nodiscard]] std::string geoName(int id);

/// Writes all fragments as polygons of one detail.
///
/// Primitives are triangles, in Houdini's order, clockwise as seen from outside, with `name`,
/// `neighbor`, unreal_gc_piece, unreal_gc_cluster, shop_materialpath where the input has materials,
/// and groups `inside` and `outside`.  Vertices have N, uv and Cd where the input has them.
///   plain   points, triangles, `name` and the attributes of Unreal only
///   source  GeoText; SideFX's Houdini Engine for Unreal, "Geometry Collections"
///   throws  Error(output); Error(cancelled)
void writeGeo(const OutputFile& file, std::span<const GeoPiece> pieces,
              const Progress* progress = nullptr, bool plain = false);

}  // namespace sherd
