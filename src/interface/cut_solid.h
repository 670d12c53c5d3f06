// A solid cut by labels: what the surfaces of its fragments are made of.
#pragma once

#include <sherd/labels.h>
#include <sherd/progress.h>
#include <sherd/solid.h>

#include <memory>
#include <span>
#include <vector>

#include "cut/cut.h"
#include "interface/cells/creases.h"
#include "interface/intact.h"
#include "voxelize/leaves/leaf_blocks.h"

namespace sherd {

/// The cut, the neighborhoods of the solid's leaves, and the creases of the input: of the intact
/// surface if there is one, else made here.
class CutSolid {
 public:
  ///   intact  of the solid, or null
  ///   throws  Error(usage) the intact surface is of another solid; Error(cancelled)
  CutSolid(const Solid& solid, const Labels& labels, std::shared_ptr<const IntactSurface> intact,
           CutExtent extent, const Progress* progress);

  /// Finds the creases, if there is no intact surface.  Only Surface::smooth needs them.
  ///   throws  Error(cancelled)
  void findCreases(const Solid& solid, const Progress* progress);

  [[nodiscard]] const Cut& cut() const { return cut_; }
  [[nodiscard]] const IntactSurface* intact() const { return intact_.get(); }
  [[nodiscard]] std::span<const LeafNeighbors> neighborhoods() const {
    return intact_ ? intact_->neighborhoods : ownNeighborhoods_;
  }
  [[nodiscard]] const Creases& creases() const { return intact_ ? intact_->creases : ownCreases_; }

 private:
  std::shared_ptr<const IntactSurface> intact_;
  std::vector<LeafNeighbors> ownNeighborhoods_;  // empty if there is an intact surface
  Cut cut_;
  Creases ownCreases_;
};

}  // namespace sherd
