// Fragments cut out of a solid some at a time.
#pragma once

#include <sherd/fragments.h>

#include <optional>
#include <span>
#include <vector>

#include "surface/contacts.h"
#include "surface/cut.h"
#include "surface/interface_mesh.h"

namespace sherd {

/// extractFragments, of which fragments are made when they are asked for: so those that were
/// written can go before others come.  All it is made of is used until its end.
class Extraction {
 public:
  ///   throws  what extractFragments throws
  Extraction(const Solid& solid, const Labels& labels, int fragments, const Labels* unworn,
             const SurfaceOptions& surface, const Progress* progress,
             const UnbrokenSurface* unbroken);
  Extraction(const Extraction&) = delete;
  Extraction& operator=(const Extraction&) = delete;

  /// The next fragments, ascending by id, without contacts; none: that was all.  As many as keep
  /// all threads busy.
  [[nodiscard]] std::vector<Fragment> next();

  /// When all were made: the contacts of each.
  [[nodiscard]] std::vector<std::vector<Contact>> contacts() const;

 private:
  /// Meshes that had to be shaped all together, until they are taken.
  struct Shaped {
    std::vector<LabelledMesh> meshes;
    std::vector<std::vector<std::uint16_t>> facing;  ///< [meshes][triangles]
    std::vector<std::vector<CoarseMesh>> coarse;     ///< [meshes], or empty
  };

  bool isShared() const;
  std::vector<std::uint16_t> facingOfShared(const LabelledMesh& mesh, std::uint16_t id) const;
  Shaped shapedTogether() const;
  std::size_t endOfRound() const;
  Fragment made(std::size_t i);
  void meshShared(Fragment& fragment);
  void meshAlone(Fragment& fragment) const;

  const Solid& solid_;
  const Labels& labels_;
  const Labels* const unworn_;
  const SurfaceOptions surface_;
  const Progress* const progress_;
  const std::size_t count_;
  const std::vector<std::uint64_t> voxels_;  ///< [fragments + 1]
  const std::vector<LeafRound> ownRounds_;   ///< where there is no unbroken surface
  const std::span<const LeafRound> rounds_;
  const Cut cut_;
  const std::vector<std::vector<std::uint32_t>> leaves_;  ///< [fragments + 1] ascending
  std::optional<InterfaceMeshes> shared_;  ///< where meshes are shared, and not shaped
  Shaped shaped_;                          ///< where they are
  ContactMeasure measure_;
  std::size_t next_ = 0;
};

}  // namespace sherd
