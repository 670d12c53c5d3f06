// The labels and the cut of a solid without cracks.
#pragma once

#include <sherd/labels.h>
#include <sherd/solid.h>

#include <cstddef>
#include <memory>
#include <utility>

#include "cut/cut.h"

namespace sherd {

/// One fragment with all voxels.
struct IntactLabels {
  Labels labels;
  Cut cut;

  explicit IntactLabels(std::shared_ptr<const LeafBlocks> blocks) {
    const std::size_t count = blocks->count();
    labels.blocks = std::move(blocks);
    labels.fragmentCount = 1;
    labels.fragment.assign(count * 512, 1);
    cut.only.assign(count, 1);
    cut.index.assign(count, Cut::kWhole);
    cut.snapWeight.resize(2);
  }
};

}  // namespace sherd
