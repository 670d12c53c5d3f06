// Scenes in Pixar's Universal Scene Description (USD).
#pragma once

#include <sherd/files.h>
#include <sherd/fragments.h>
#include <sherd/progress.h>

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "formats/mesh/piece_mesh.h"

namespace sherd {

/// A fragment of a USD scene.
struct UsdPiece {
  int id = 0;
  PieceMesh piece;
  MassProperties mass;
  std::span<const Contact> contacts;  ///< those with fragments that are not in the scene are left
                                      ///< out
  std::size_t split = 0;              ///< that it comes from, 1..UsdScene::parentOfSplit; 0: none
  std::string volume{};               ///< file of its level set, relative to the scene's; or empty
};

struct UsdScene {
  std::string name;                          ///< of the root
  std::vector<UsdPiece> pieces{};            ///< ascending by id
  std::vector<std::size_t> parentOfSplit{};  ///< [splits] number of the split that it comes from,
                                             ///< below its own; 0: none
  std::string textureFolder{};  ///< relative to the scene's file, with a slash, or empty
  double density = 1.0;         ///< mass per unit of volume
  double strength = 1.0;        ///< break force of a joint per unit of its contact's area
  double metersPerUnit = 1.0;
  char up = 'y';  ///< or 'z'
};

/// Writes a scene as text: an Xform with a Material for each of the table's, a rigid body for each
/// piece, with mass, diagonal inertia and principal axes, its mesh with a convex hull as collider,
/// and a fixed joint for each contact, which breaks at strength times area.
///
/// A piece is an Xform at its center of mass, named like its mesh.  Faces have the uniform primvar
/// `neighbor`, the subsets of the family materialBind, and face-varying normals and, where the
/// input has some, `st` and `displayColor`.  Pieces that were split are Xforms around those that
/// come of them.  The variant set `preview` has `whole` and `exploded`, in which pieces are apart
/// and joints inactive.
///   source  OpenUSD 24.11: UsdGeom, UsdShade, UsdPhysics, UsdVol; UsdPreviewSurface 2.6
///   throws  Error(output); Error(cancelled)
void writeUsda(const OutputFile& file, const UsdScene& scene, const Progress* progress = nullptr);

/// Writes the same, without volumes, in an uncompressed archive with the textures that are PNG or
/// JPEG.
///   throws  Error(output), also if it would have 2^32 bytes or more
void writeUsdz(const OutputFile& file, const UsdScene& scene, const Progress* progress = nullptr);

}  // namespace sherd
