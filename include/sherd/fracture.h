// The complete pipeline, from a mesh to fragments; breaking fragments again; and the memory it
// takes.
#pragma once

#include <sherd/device.h>
#include <sherd/fragments.h>
#include <sherd/labels.h>
#include <sherd/mesh.h>
#include <sherd/progress.h>
#include <sherd/seeds.h>
#include <sherd/solid.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace sherd {

/// What is broken: a preset of options, see materialOptions.
enum class MaterialPreset : std::uint8_t {
  none,
  ceramic,
  stone,
  glass,
  tempered,  ///< tempered glass
  plaster,
  wood,
  concrete,
  ice
};

/// Which fragments FractureOptions::missing withholds.
enum class MissingRule : std::uint8_t {
  neighbors,  ///< so that each that is kept touches another one that is, wherever that can be
  any,        ///< any, by their random ids: some that are kept may touch none that is
};

/// Cracks that are given: the first splits of growth by splits follow them.
struct Guide {
  std::string file{};                                ///< named in messages and manifests
  std::vector<std::vector<glm::dvec3>> polylines{};  ///< each with two points or more: cracks pass
                                                     ///< through them across the surface near them
  TriangleMesh mesh{};   ///< its surface becomes a crack; open or closed
  std::string sha256{};  ///< of the file's bytes, 64 hexadecimal digits; recorded unless empty
};

/// Options of a fracture, by stage.  `pieces` and `seed` are those of the whole: a stage's own
/// (SeedOptions::pieces and seed, GrowOptions::noiseSeeds, ErodeOptions::seed) are derived from
/// them, and refused where they are set.  So are GrowOptions::longestSideVoxels and walls, and
/// ErodeOptions::longestSideVoxels and least, which are derived from the solid.
struct FractureOptions {
  MaterialPreset material = MaterialPreset::none;  ///< whose options these are; only recorded
  int pieces = 8;                                  ///< fragments wanted, 1..kMaxFragments
  std::uint64_t seed = 0;
  SolidOptions solid{};
  SeedOptions seeds{};
  GrowOptions grow{};
  ShareOptions shares{};
  ErodeOptions erode{};
  std::vector<Guide> guides{};
  double dropShare = 0.0;  ///< withholds fragments below this share of the solid's voxels, 0..1
  double missing = 0.0;    ///< withholds further fragments: a number if >= 1, a share if below 1
  MissingRule missingRule = MissingRule::neighbors;
  SurfaceOptions surface{};
};

/// As surfaceOf(options.surface), and Surface::smooth if the whole surface is eroded.
[[nodiscard]] Surface surfaceOf(const FractureOptions& options);

/// Returns options.shares; where there are impacts, which set the sizes of pieces, without sizes
/// that the material draws.
[[nodiscard]] ShareOptions sharesOf(const FractureOptions& options);

/// Returns the options of the paper's section 4.1: 128 voxels, uniform seeds, two extra seeds per
/// fragment merged by the Chebyshev metric, a flood over 6 neighbors, no erosion, meshes of the
/// labels, smoothed for 0.048 iterations per voxel of the longest side, with weights of 0.2 at
/// cracks and 0.9 elsewhere.  Where the published program differs (0.015 iterations at cracks, the
/// Euclidean metric), the paper is followed.  `pieces` keeps its default: the paper uses 2 to 10.
///   source  Generating implicit object fragment datasets for machine learning
[[nodiscard]] FractureOptions paperOptions();

/// Returns options for data that networks learn to assemble from: no vertex of a fragment is one of
/// its neighbors', cracks are not planes, sizes are uneven, and no fragment is a speck.  Sizes and
/// cracks are as near to those of Breaking Bad as seeds make them (docs/training.md).  The option
/// `--preset training` draws roughness, mismatch, noise and missing fragments too (presetDraws).
[[nodiscard]] FractureOptions trainingOptions();

/// Returns `options` with those by which a material breaks: growth, splits, grain, roughness, sizes
/// and erosion, each set even where the material has its default.  Lengths are percentages of the
/// longest side.  With MaterialPreset::none nothing changes.
///   source  docs/materials.md, for each value
[[nodiscard]] FractureOptions materialOptions(MaterialPreset material,
                                              FractureOptions options = {});

/// The wall-clock time of one stage.
struct StageTime {
  std::string stage;
  double seconds = 0.0;
};

/// How a fracture that is broken again came to be: each break before the last one, the first one
/// first, as the text of a JSON object (docs/formats.md).
struct BreakHistory {
  std::vector<std::string> breaks{};
  std::size_t omitted = 0;  ///< after the first one, as there were too many
  std::string sha256{};     ///< of the manifest of what is broken again; empty: it was in memory
};

struct FractureResult {
  Solid solid;
  std::size_t components = 0;  ///< 6-connected components of the solid
  std::vector<Seed> seeds;
  SeedsOn seedsOn = SeedsOn::volume;  ///< what SeedsOn::automatic came to, else that of the options
  Labels labels;                      ///< after erosion
  std::vector<std::uint64_t> eroded;  ///< [fragments+1] eroded voxels of each, [0] the sum
  std::vector<Fragment> fragments;    ///< [max(pieces, components)] ascending by id
  std::shared_ptr<const FragmentSurfaces>
      surfaces{};  ///< without SurfaceOptions::meshes, else null
  std::shared_ptr<const FragmentSurfaces>
      unmerged{};              ///< with SurfaceOptions::points, if triangles of meshes are merged
  std::string exactFailure{};  ///< why Surface::exact was replaced by Surface::smooth, as a clause;
                               ///< empty if it was not, or only where `smooth` says so
  std::vector<SmoothBodies> smooth{};  ///< where Surface::exact was replaced and others have it
  UnitedBodies united{};               ///< of Surface::exact
  std::size_t withheld = 0;            ///< the last `withheld` fragments are withheld
  std::size_t alone = 0;  ///< with `missing`, of two kept fragments or more: those whose neighbors
                          ///< are all withheld
  std::vector<int> objectOf{};  ///< [fragments] of an assemblage (dataset.h): the object that
                                ///< each is of, from 0; else empty
  std::vector<int> parents;     ///< [fragments] of refracture: id of the old fragment that
                                ///< each comes from; else empty
  double sizeError = 0.0;       ///< with ShareOptions::sizes, the greatest difference of a grown
                                ///< share from the one drawn for it, divided by that
  std::vector<std::string> guideWarnings{};  ///< a sentence for each of FractureOptions::guides
                                             ///< that splits nothing, or of which a part does not
  std::vector<StageTime> times;
  std::vector<int> broken{};  ///< of refracture: the old fragments that were broken, ascending
  BreakHistory history{};     ///< of refracture: FinishedFracture::history

  std::size_t kept() const { return fragments.size() - withheld; }
};

/// Breaks a mesh: voxelize, findComponents, placeSeeds or seedsFromPoints, grow (repeated as
/// ShareOptions require), erode and extractFragments, in this order.  Components under
/// kSmallComponentVoxels voxels are dropped before seeding.  Withheld fragments get the last ids;
/// ids are a random permutation, so `missing` withholds random fragments.
///   throws  what these functions throw; Error(usage) no fragment would be left
[[nodiscard]] FractureResult fracture(const TriangleMesh& mesh, const FractureOptions& options,
                                      Device& device, const Progress* progress = nullptr);

/// Breaks an existing solid: the same without voxelize, whose options are ignored.
[[nodiscard]] FractureResult fracture(Solid solid, const FractureOptions& options, Device& device,
                                      const Progress* progress = nullptr);

class SolidWalls;
class DecidingSolids;

/// A solid with what is computed once for any number of fractures.
struct PreparedSolid {
  Solid solid;                                     ///< without small components
  VoxelComponents components;                      ///< of the solid
  std::shared_ptr<const IntactSurface> surface{};  ///< of the solid, or null
  /// Of the solid, found by the first fracture that needs them and kept, 3 KiB for each leaf node;
  /// null, or of a solid with other leaf blocks: found for each fracture.
  std::shared_ptr<SolidWalls> walls{};
  /// On which splits are decided, found by the first fracture that needs it and kept; null: found
  /// for each fracture.
  std::shared_ptr<DecidingSolids> deciding{};
};

/// Drops small components and finds the others; leaves `surface` null.
///   throws  Error(input) the solid has only components under kSmallComponentVoxels voxels
[[nodiscard]] PreparedSolid prepared(Solid solid, Device& device);

/// Breaks a prepared solid.
[[nodiscard]] FractureResult fracture(const PreparedSolid& prepared, const FractureOptions& options,
                                      Device& device, const Progress* progress = nullptr);

/// A fracture that can be broken again: read from its folder, or of finishedFracture.
struct FinishedFracture {
  /// Of a fracture in memory, the mesh that was broken.  Of one that was read, the file name of the
  /// original mesh and the SHA-256 of the manifest; after readFragmentMeshes the mesh is the faces
  /// of the fragments' original surface, with the attributes that their files have.
  SourceMesh source;
  int resolution = 0;
  Solid solid;    ///< the union of the fragments, without eroded and withheld voxels
  Labels labels;  ///< an id on every inside voxel
  /// Of the fragments' meshes, which Surface::exact cuts: the faces of one fragment after another,
  /// with neighbors; fragment i has [firstFace[i-1], firstFace[i]).  Both are empty
  /// until readFragmentMeshes, or where there are no meshes.
  TriangleMesh faces{};
  std::vector<std::size_t> firstFace{};  ///< [fragments + 1]
  bool isExact = false;  ///< some fragments have exact surfaces; Surface::automatic then cuts them
  BreakHistory history{};                 ///< of what breaks it again: with the break that made it
  std::vector<std::uint32_t> sourceOf{};  ///< [faces] index in the source's mesh; of those that are
                                          ///< not in it TriangleMesh::kNoSource
  std::filesystem::path manifest{};       ///< that was read; empty: none was
};

/// Breaks some fragments again, each into options.pieces; the others stay.  Options of the whole
/// (resolution, voxel size, seed file, missing, erosion) are ignored.
///
/// Fragments that are not broken keep their ids.  The first part of a broken one has its id, so
/// that ids are 1..n; the other parts follow the last id, in the order of the broken fragments'
/// ids.
///
/// With Surface::exact the broken fragments' own meshes are cut, and the others stay as they are:
/// their vertices and triangles do not change where they touch a fragment that is broken.
///   only    ids of the fragments to break, 1..labels.fragmentCount
///   return  as fracture(); `parents` has the old fragment that each is or comes from
///   throws  Error(usage) an id that does not exist; what placeSeeds and grow throw
[[nodiscard]] FractureResult refracture(const FinishedFracture& finished, std::span<const int> only,
                                        const FractureOptions& options, Device& device,
                                        const Progress* progress = nullptr);

/// Which fragments' meshes are in memory at once.
enum class MeshesHeld {
  all,
  some,     ///< a batch, as in fractureInto if WriteOptions::needsAllMeshes is false
  preview,  ///< a batch, and the coarse meshes of WriteOptions::preview
};

/// Estimates the bytes that breaking a mesh takes at most, the mesh and the files' bytes included,
/// from the mesh's area and volume in voxels at rates measured on many fractures
/// (docs/performance.md).  The estimate is above the measured peak, by at most a factor of two.
[[nodiscard]] std::uint64_t estimatedMemory(const TriangleMesh& mesh,
                                            const FractureOptions& options,
                                            MeshesHeld held = MeshesHeld::all);

/// Refuses to break a mesh that would not fit.  An automatic resolution is computed only if the
/// highest one would not fit.
///   throws  Error(usage) the estimate is above `limit`; the message names a resolution that fits,
///           and whether the requested one would fit with MeshesHeld::some; what voxelSizeFor
///           throws
void requireMemory(const TriangleMesh& mesh, const FractureOptions& options, std::uint64_t limit,
                   MeshesHeld held = MeshesHeld::all);

}  // namespace sherd
