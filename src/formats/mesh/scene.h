// Fragments as a scene of rigid bodies, in any format.
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

/// A fragment of a scene.
struct ScenePiece {
  int id = 0;
  PieceMesh piece;
  std::vector<PieceMesh> coarse{};  ///< of fewer triangles, the finest first; at each level cracks
                                    ///< are those of the neighbors
  MassProperties mass;
  std::span<const Contact> contacts;  ///< those with fragments that are not in the scene are left
                                      ///< out
  std::size_t split = 0;    ///< that it comes from, 1..FragmentScene::parentOfSplit; 0: none
  std::string volume{};     ///< file of its level set, relative to the scene's; or empty
  double volumeUnit = 1.0;  ///< world units that one of the file's stands for
};

struct FragmentScene {
  std::string name;                          ///< of the root
  std::vector<ScenePiece> pieces{};          ///< ids 1, 2, ...; they share one table of materials
  std::vector<std::size_t> parentOfSplit{};  ///< [splits] number of the split that it comes from,
                                             ///< below its own; 0: none
  std::string textureFolder{};     ///< relative to the scene's file, with a slash, or empty
  double density = 1.0;            ///< kilograms per cubic meter
  double strength = 1.0;           ///< newtons per square meter of a contact that break its joint
  CoordinateSystem coordinates{};  ///< of the meshes, masses and contacts
  bool plain = false;              ///< meshes have vertices and triangles only, no materials

  /// Kilograms per cubic unit of the coordinates.
  [[nodiscard]] double densityOfUnits() const {
    const double m = coordinates.metersPerUnit;
    return density * m * m * m;
  }
  /// Newtons per square unit.
  [[nodiscard]] double strengthOfUnits() const {
    const double m = coordinates.metersPerUnit;
    return strength * m * m;
  }
};

/// Levels deeper than this are one with it.
inline constexpr std::size_t kDeepestLevel = 32;

/// What is written below a split, or the whole.
struct SceneLevel {
  std::vector<std::size_t> pieces{};  ///< indices into FragmentScene::pieces
  std::vector<std::size_t> splits{};  ///< numbers of splits

  [[nodiscard]] bool empty() const { return pieces.empty() && splits.empty(); }
};

/// Returns the levels: the whole and that of each split. Those of splits without pieces are in no
/// other.  Below kDeepestLevel the pieces of a split are those of the one that it comes from.
///   return  [1 + splits]
[[nodiscard]] std::vector<SceneLevel> levelsOf(const FragmentScene& scene);

/// Returns the name of a split's node, which is no name of a piece: those end in '_' and digits.
[[nodiscard]] inline std::string splitName(std::size_t split) {
  return "split" + std::to_string(split);
}

/// A contact between two pieces of a scene.
struct SceneJoint {
  std::size_t one = 0, other = 0;  ///< indices into FragmentScene::pieces, in ascending order
  const Contact* contact = nullptr;
};

/// Returns the name of a piece's mesh where it has several: LOD0 is the whole one.
[[nodiscard]] inline std::string lodName(std::size_t level) {
  return "LOD" + std::to_string(level);
}

/// Returns the contacts between pieces of a scene, see forEachContact.
[[nodiscard]] std::vector<SceneJoint> jointsOf(const FragmentScene& scene);

/// Writes a scene as binary glTF 2.0 with embedded PNG and JPEG textures: a node for each piece at
/// its center of mass, named like its mesh, with KHR_physics_rigid_bodies: mass, inertia and the
/// mesh's convex hull as collider.  A contact is a fixed joint between two nodes at its centroid,
/// below those of its pieces, with area and break force as extras.  Pieces that were split are
/// nodes around those that come of them.  A piece with coarse meshes has its mesh in a node below,
/// NAME_LOD0, whose MSFT_lod names the nodes of the others.
///   source  KHR_physics_rigid_bodies, draft of October 2025; MSFT_lod
///   throws  Error(output), also if it would have 2^32 bytes or more; Error(cancelled)
void writeSceneGlb(const OutputFile& file, const FragmentScene& scene,
                   const Progress* progress = nullptr);

}  // namespace sherd
