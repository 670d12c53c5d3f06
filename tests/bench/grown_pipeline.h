// Fractures of one solid in a pipeline like that of a dataset.
#pragma once

#include <sherd/fracture.h>
#include <tbb/parallel_pipeline.h>

#include <atomic>
#include <functional>
#include <memory>

#include "base/uncancelled.h"
#include "pipeline/fracture_stages.h"

namespace sherd {

/// Grows fractures in two to ten pieces, one after another, and calls `use` with each meanwhile,
/// from several threads.
///   return  the number of all fragments
inline std::size_t forEachGrown(const PreparedSolid& ready, std::size_t fractures, Device& device,
                                const Progress* progress,
                                const std::function<void(const GrownFracture&)>& use) {
  using Grown = std::shared_ptr<const GrownFracture>;
  std::size_t next = 0;
  std::atomic<std::size_t> fragments = 0;
  const auto growNext = [&](tbb::flow_control& control) -> Grown {
    if (next == fractures) {
      control.stop();
      return nullptr;
    }
    FractureOptions options;
    options.pieces = 2 + static_cast<int>(next % 9);
    options.seed = next++;
    Grown grown;
    uncancelled([&] {
      grown = std::make_shared<const GrownFracture>(
          grow(ready, options, device, StageClock(), progress));
    });
    return grown;
  };
  const auto useOne = [&](const Grown& grown) {
    uncancelled([&] { use(*grown); });
    fragments += static_cast<std::size_t>(grown->result.labels.fragmentCount);
  };
  using Mode = tbb::filter_mode;
  tbb::parallel_pipeline(3, tbb::make_filter<void, Grown>(Mode::serial_in_order, growNext) &
                                tbb::make_filter<Grown, void>(Mode::parallel, useOne));
  return fragments;
}

}  // namespace sherd
