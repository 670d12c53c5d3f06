// Extraction of fragments in batches.
#pragma once

#include <sherd/fragments.h>

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "interface/contacts.h"
#include "interface/cut_solid.h"
#include "surface/exact/exact_surface.h"
#include "surface/fragment_surfaces.h"
#include "surface/simplify.h"
#include "surface/surface_noise.h"

namespace sherd {

/// extractFragments() in batches, so that the caller can write and free a batch before the next is
/// made.  All constructor arguments must outlive the object.
class Extraction {
 public:
  ///   throws  what extractFragments throws
  Extraction(const Solid& solid, const Labels& labels, const ExtractOptions& options,
             const Progress* progress);
  Extraction(const Extraction&) = delete;
  Extraction& operator=(const Extraction&) = delete;

  /// Returns the next batch of fragments, ascending by id, without contacts; empty after the last.
  /// A batch is large enough to keep all threads busy.
  [[nodiscard]] std::vector<Fragment> next();

  /// Returns the contacts of each fragment.  Precondition: next() has returned all.
  [[nodiscard]] std::vector<std::vector<Contact>> contacts() const;

  /// Returns FractureResult::surfaces.
  [[nodiscard]] std::shared_ptr<const FragmentSurfaces> surfaces() const { return surfaces_; }

  /// Returns FractureResult::unmerged, if SurfaceOptions::points asks for it.
  [[nodiscard]] std::shared_ptr<const FragmentSurfaces> unmerged() const { return unmerged_; }

  /// Returns FractureResult::exactFailure.
  [[nodiscard]] const std::string& exactFailure() const { return exactFailure_; }

  /// Returns FractureResult::smooth.
  [[nodiscard]] const std::vector<SmoothBodies>& smooth() const { return smooth_; }

  /// Returns FractureResult::united.
  [[nodiscard]] const UnitedBodies& united() const { return united_; }

 private:
  /// Meshes that are exact, smoothed or decimated together, until next() moves them out.
  struct Processed {
    std::vector<LabeledMesh> meshes;
    std::vector<std::vector<TriangleMesh>> coarse;  ///< [meshes], or empty
    std::vector<std::vector<CutFace>> cutFaces{};   ///< [meshes], or empty
  };

  bool isShared() const { return surface_.interface == Interface::shared; }
  bool isSmooth(std::size_t i) const { return meshedAs_[i] == Surface::smooth; }
  ContactSums voxelContactsOf() const;
  void cutAnew();
  void makeSmooth();
  LabeledMesh smoothMesh(const FragmentSurfaces& surfaces, std::size_t i) const;
  void processTogether(std::shared_ptr<const FragmentSurfaces> surfaces);
  void makeExact(ExactSurface exact);
  void partKinds(LabeledMesh& mesh, std::size_t i) const;
  std::size_t endOfBatch() const;
  Fragment makeFragment(std::size_t i);
  void meshShared(Fragment& fragment);
  void cutSeams(Fragment& fragment) const;
  void meshIndependent(Fragment& fragment) const;
  void addNoise(std::span<Fragment> fragments) const;

  const Solid& solid_;
  const Labels& labels_;
  const Labels* const uneroded_;
  SurfaceOptions surface_;  ///< smooth where exact surfaces fail for some fragments or all
  const bool keepsUnmerged_;
  const Progress* const progress_;
  const std::shared_ptr<const IntactSurface> intact_;  ///< as ExtractOptions::intact
  const std::uint64_t seed_;
  const SurfaceNoise noise_;
  const std::size_t count_;
  const std::vector<std::uint64_t> voxels_;  ///< [fragments + 1]
  const std::vector<VoxelBox> boxes_;        ///< [fragments + 1]
  std::shared_ptr<CutSolid> cut_;
  Simplification simplification_{};
  std::vector<std::vector<std::uint32_t>> leaves_;    ///< [fragments + 1] ascending
  std::shared_ptr<const FragmentSurfaces> surfaces_;  ///< if meshes are shared, not processed
  std::shared_ptr<const FragmentSurfaces> unmerged_;
  std::shared_ptr<const FragmentSurfaces> resampled_;  ///< if fragments are meshed independently
  Processed processed_;                                ///< if meshes are processed, or exact
  std::vector<Surface> meshedAs_;                      ///< [fragments]
  std::string exactFailure_;
  std::vector<SmoothBodies> smooth_;
  UnitedBodies united_;
  ContactMeasure measure_;
  std::size_t next_ = 0;
};

/// All fragments, with contacts.
struct ExtractedFragments {
  std::vector<Fragment> fragments;
  std::string exactFailure{};                                      ///< as Extraction::exactFailure
  std::vector<SmoothBodies> smooth{};                              ///< as Extraction::smooth
  std::shared_ptr<const FragmentSurfaces> surfaces{}, unmerged{};  ///< as those of Extraction
  UnitedBodies united{};                                           ///< as Extraction::united
};

/// As extractFragments.
[[nodiscard]] ExtractedFragments extractAll(const Solid& solid, const Labels& labels,
                                            const ExtractOptions& options,
                                            const Progress* progress = nullptr);

/// Returns the fragments of surfaces, without meshes.
///   labels    as the surfaces were made of
///   uneroded  likewise, or null
///   throws    as extractFragments
[[nodiscard]] std::vector<Fragment> measuredFragments(const FragmentSurfaces& surfaces,
                                                      const Solid& solid, const Labels& labels,
                                                      const Labels* uneroded,
                                                      const Progress* progress);

}  // namespace sherd
