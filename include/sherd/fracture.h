// The whole way from a mesh to fragments.
#pragma once

#include <sherd/erode.h>
#include <sherd/fragments.h>
#include <sherd/labels.h>
#include <sherd/mesh.h>
#include <sherd/progress.h>
#include <sherd/seeds.h>
#include <sherd/shares.h>
#include <sherd/solid.h>
#include <sherd/surface.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace sherd {

struct FractureOptions {
  int pieces = 8;  ///< fragments wanted, 1..kMaxFragments
  std::uint64_t seed = 0;
  int resolution = kAutoResolution;  ///< see SolidOptions; used when voxelSize is 0
  double voxelSize = 0.0;            ///< world units per voxel; 0: from resolution
  Fill fill = Fill::automatic;       ///< how the mesh tells its inside
  double shellThickness = 0.0;       ///< see SolidOptions

  SeedOptions seeds{};               ///< its `pieces` and `seed` are taken from above
  int extraSeedsPerPiece = 0;        ///< extra seeds beside seeds.extraSeeds, for each fragment
  std::filesystem::path seedFile{};  ///< explicit seeds in place of placed ones; empty: none
  GrowOptions grow{};                ///< its noise seed is made from `seed`
  ShareOptions shares{};
  ErodeOptions erode{};    ///< its `seed` is taken from above
  double dropShare = 0.0;  ///< fragments of a lesser share of the solid's voxels are withheld, 0..1
  double missing = 0.0;    ///< of the others: withheld too, a number from 1 up, or below 1 a share
  SurfaceOptions surface{};
};

/// Options as section 4.1 of the paper has them: 128 voxels, seeds drawn evenly, two extra seeds a
/// fragment merged by Chebyshev's metric, a flood over 6 neighbours, no erosion, meshes of the bare
/// labels, smoothed 0.048 times the longest side's voxels, by 0.2 at cracks and by 0.9 elsewhere.
/// Where the published program differs (0.015 in place of 0.048 at cracks, Euclid's metric), the
/// paper is followed.  The number of pieces is left at the default: the paper has every one from 2
/// to 10.
///   source  Generating implicit object fragment datasets for machine learning
[[nodiscard]] FractureOptions paperOptions();

/// Seconds that one stage took.
struct StageTime {
  std::string stage;
  double seconds = 0.0;
};

struct FractureResult {
  Solid solid;
  std::size_t parts = 0;  ///< 6-connected parts of the solid
  std::vector<Seed> seeds;
  Labels labels;                    ///< as they are after erosion
  std::vector<std::uint64_t> worn;  ///< [fragments+1] worn voxels of each, [0] of all
  std::vector<Fragment> fragments;  ///< [max(pieces, parts)] ascending by id
  std::size_t withheld = 0;         ///< how many of the last fragments are withheld
  std::vector<int> parents;         ///< [fragments] of refracture: the old fragment each comes
                                    ///< from; empty where a mesh was broken
  std::vector<StageTime> times;

  std::size_t kept() const { return fragments.size() - withheld; }
};

/// Break a mesh: voxelize, findParts, placeSeeds or readSeeds, growWithShares, erode and
/// extractFragments, in this order.  Between them parts under kSpeckVoxels voxels are dropped, and
/// fragments that are withheld get the last ids; ids are a random permutation, so withholding by
/// number withholds random ones.
///   throws  what they throw; Error(usage) nothing would be left, or seeds of a file and pieces
///           disagree
[[nodiscard]] FractureResult fracture(const TriangleMesh& mesh, const FractureOptions& options,
                                      Device& device, const Progress* progress = nullptr);

/// Break a solid that is there already: the same without voxelize.  Options that tell how to
/// voxelize are not used.
[[nodiscard]] FractureResult fracture(Solid solid, const FractureOptions& options, Device& device,
                                      const Progress* progress = nullptr);

/// A solid that can be broken any number of times.
struct PreparedSolid {
  Solid solid;                                       ///< without specks
  Parts parts;                                       ///< of the solid
  std::shared_ptr<const UnbrokenSurface> surface{};  ///< of the solid, or null
};

///   throws  Error(input) the solid has nothing but specks
[[nodiscard]] PreparedSolid prepared(Solid solid, Device& device);

/// The same, of which only what is new for each fracture is done.
[[nodiscard]] FractureResult fracture(const PreparedSolid& prepared, const FractureOptions& options,
                                      Device& device, const Progress* progress = nullptr);

}  // namespace sherd
