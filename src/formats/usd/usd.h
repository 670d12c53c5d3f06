// Scenes in Pixar's Universal Scene Description (USD).
#pragma once

#include <sherd/files.h>
#include <sherd/progress.h>

#include "formats/mesh/scene.h"

namespace sherd {

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
void writeUsda(const OutputFile& file, const FragmentScene& scene,
               const Progress* progress = nullptr);

/// Writes the same, without volumes, in an uncompressed archive with the textures that are PNG or
/// JPEG.
///   throws  Error(output), also if it would have 2^32 bytes or more
void writeUsdz(const OutputFile& file, const FragmentScene& scene,
               const Progress* progress = nullptr);

}  // namespace sherd
