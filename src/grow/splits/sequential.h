// Growth::sequential: a solid is split again and again in two.
#pragma once

#include <sherd/labels.h>

#include <cstdint>
#include <glm/mat3x3.hpp>
#include <memory>
#include <span>
#include <vector>

#include "grow/fields/seeded_labels.h"
#include "grow/splits/given_splits.h"
#include "grow/splits/guide_sides.h"
#include "seed/split_impacts.h"
#include "voxelize/wall_middles.h"

namespace sherd {

/// What is split in one fracture.
struct SplitRun {
  std::vector<double> shares;  ///< that fragments are meant to have, in random order; the sum is 1
  std::uint64_t seed = 0;      ///< of all random numbers
  std::span<const glm::dmat3> walls{};  ///< [leaves] see wall_normals.h; none: cracks are not
                                        ///< rotated into walls
  const GuideSides* guides = nullptr;   ///< of the first splits, or null; the same of all runs
  std::shared_ptr<const WallMiddles> middles{};  ///< that cracks are compared with, or null; the
                                                 ///< same of all runs that have them
  std::span<const SplitImpact> impacts{};  ///< of which cracks are the first after those of guides
  std::span<const double> densities{};     ///< [leaves] see leaf_densities.h; shares are of voxels
                                           ///< times these.  None: of voxels
  const GivenSplits* given = nullptr;      ///< or null: of the run's shares, in its solid's voxels.
                                       ///< Splits that the voxels do not resolve are decided anew
};

/// A fracture whose shares are drawn.
struct SequentialFracture {
  std::size_t fragments = 0;
  std::uint64_t seed = 0;
  std::vector<double> densities{};     ///< as in SplitRun
  std::vector<SplitImpact> impacts{};  ///< as in SplitRun
  SeedsOn on = SeedsOn::automatic;     ///< wall: cracks go straight through walls; volume: they are
                                       ///< not even rotated into them
  bool isDecidedElsewhere = false;     ///< on DecidingSolid, of which densities and impacts are
};

/// Grows fragments by splits, then the same as `grow`: roughness, regrowth, extension into the
/// exterior band.  A crack ends at the border of its piece, so older cracks stop newer ones.
///   components  of the solid, as many as a run's shares or fewer
///   runs        fractures, grown together in batches that fit the device
///   return      [runs] labels with their splits, and an inner voxel of each fragment
///   throws      Error(device); Error(cancelled); Error(usage) an option out of range, more shares
///               than voxels
///   source      Domokos, Jerolmack, Kun, Toeroek, Plato's cube and the natural geometry of
///               fragmentation, PNAS 117:18178, 2020 (binary breakup)
[[nodiscard]] std::vector<SeededLabels> growBySplits(std::shared_ptr<const LeafBlocks> blocks,
                                                     const VoxelComponents& components,
                                                     std::span<const SplitRun> runs, Device& device,
                                                     const GrowOptions& options,
                                                     const Progress* progress = nullptr);

/// Decides the splits of runs, none of which has given ones.
///   throws  as growBySplits
[[nodiscard]] std::vector<GivenSplits> decideSplits(const LeafBlocks& blocks,
                                                    const VoxelComponents& components,
                                                    std::span<const SplitRun> runs, Device& device,
                                                    const GrowOptions& options,
                                                    const Progress* progress = nullptr);

/// A solid of the same mesh on which splits are decided.  All by reference.
struct DecidingSolid {
  const Solid& solid;
  SolidWalls& walls;
  const VoxelComponents& components;
  const GuideSides& guides;
  std::span<const std::uint32_t> component;  ///< [components of the other] those of this one
};

/// The same with shares that are drawn, by ShareOptions or as splits give them, and drawn again
/// where a fragment is below the least one.
///   walls     of the solid
///   guides    see SplitRun
///   deciding  of fractures that are decided elsewhere; null if there are none
///   throws  also Error(usage) the least share cannot be reached, or not within the tries
[[nodiscard]] std::vector<SeededLabels> growSequential(
    const Solid& solid, SolidWalls& walls, const VoxelComponents& components,
    std::span<const SequentialFracture> fractures, Device& device, const GrowOptions& options,
    const ShareOptions& shares, const GuideSides& guides, const DecidingSolid* deciding,
    const Progress* progress = nullptr);

}  // namespace sherd
