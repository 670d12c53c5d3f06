// Flood growth on the device.  The method is described in kernels/flood.cl.
#include <sherd/error.h>
#include <sherd/labels.h>

#include <algorithm>
#include <bit>
#include <map>
#include <string>

#include "cl/device_impl.h"
#include "leaf_block.h"

namespace sherd {
namespace {

// The seeds of all fractures, grouped by the item (fracture * leaves + leaf) that holds them.
struct SeedTable {
  std::vector<cl_uint> item, first;
  std::vector<cl_ushort> offset, label;
};

SeedTable tableOf(const LeafBlocks& blocks, std::span<const std::vector<Seed>> seedSets) {
  // Ordered by item and offset; of two seeds on one voxel the lower id stays.
  std::map<std::pair<std::uint64_t, std::uint32_t>, std::uint16_t> sorted;
  for (std::size_t f = 0; f < seedSets.size(); ++f) {
    for (const Seed& seed : seedSets[f]) {
      const std::uint32_t leaf = findLeaf(blocks, seed.voxel);
      const auto offset = static_cast<std::uint32_t>(
          ((seed.voxel.x() & 7) << 6) | ((seed.voxel.y() & 7) << 3) | (seed.voxel.z() & 7));
      if (leaf == LeafBlocks::kNone ||
          !((blocks.inside[leaf * 8 + (offset >> 6)] >> (offset & 63)) & 1) || seed.fragment == 0) {
        throw Error(ErrorCode::usage, "seed of fragment " + std::to_string(seed.fragment) +
                                          " does not lie on a voxel of the solid");
      }
      const auto [at, added] =
          sorted.try_emplace({f * blocks.count() + leaf, offset}, seed.fragment);
      if (!added) at->second = std::min(at->second, seed.fragment);
    }
  }
  SeedTable table;
  for (const auto& [key, label] : sorted) {
    if (table.item.empty() || table.item.back() != key.first) {
      table.item.push_back(static_cast<cl_uint>(key.first));
      table.first.push_back(static_cast<cl_uint>(table.offset.size()));
    }
    table.offset.push_back(static_cast<cl_ushort>(key.second));
    table.label.push_back(label);
  }
  table.first.push_back(static_cast<cl_uint>(table.offset.size()));
  return table;
}

// One growth on the device: its buffers, and the kernels launched over them.
class Flood {
 public:
  Flood(const LeafBlocks& blocks, std::size_t fractures, Device::Impl& device,
        const GrowOptions& options)
      : device_(device),
        leafCount_(static_cast<cl_uint>(blocks.count())),
        items_(static_cast<cl_uint>(blocks.count() * fractures)),
        group_(options.workGroupSize > 0 ? static_cast<std::size_t>(options.workGroupSize)
                                         : device.workGroupSize()),
        keepCost_(options.keepCost),
        neighbour_(uploadBuffer<std::uint32_t>(device, blocks.neighbours)),
        owned_(filled<cl_ulong>(items_ * std::size_t{SHERD_LEAF_WORDS}, 0)),
        tag_(filled<cl_uint>(items_, 0)),
        owner_(makeBuffer<cl_ushort>(device, items_ * std::size_t{SHERD_LEAF_SIZE})),
        frontMask_(makeBuffer<cl_ulong>(device, 2 * items_ * std::size_t{SHERD_LEAF_WORDS})),
        frontStep_(filled<cl_uint>(2 * std::size_t{items_}, SHERD_NO_STEP)),
        frontTag_(makeBuffer<cl_uint>(device, 2 * std::size_t{items_})),
        queued_(filled<cl_uint>(items_, SHERD_NO_STEP)),
        list_(makeBuffer<cl_uint>(device, 2 * std::size_t{items_})),
        listCount_(filled<cl_uint>(3, 0)),
        cost_(keepCost_ ? filled<cl_uint>(items_ * std::size_t{SHERD_LEAF_SIZE}, 0)
                        : makeBuffer<cl_uint>(device, 1)) {}

  void seed(const SeedTable& table) {
    const cl::Buffer item = uploadBuffer<cl_uint>(device_, table.item);
    const cl::Buffer first = uploadBuffer<cl_uint>(device_, table.first);
    const cl::Buffer offset = uploadBuffer<cl_ushort>(device_, table.offset);
    const cl::Buffer label = uploadBuffer<cl_ushort>(device_, table.label);
    const auto seedItems = static_cast<cl_uint>(table.item.size());
    launch("flood_seed", table.item.size(), item, first, offset, label, seedItems);
    device_.queue.finish();  // the table's buffers end here
  }

  void domain(std::span<const std::uint64_t> masks) {
    domain_ = uploadBuffer<std::uint64_t>(device_, masks);
  }

  // Go on from all that is owned into the domain as it is now.
  void restart() { launch("flood_restart", items_, step_); }

  // Take up to `steps` layers, looking every `perReadback` whether anything is left to do.
  void grow(std::uint32_t steps, std::uint32_t perReadback, const Progress* progress) {
    cl::Kernel kernel = device_.kernel("flood.cl", "flood_step");
    const cl_uint stepArgument = setState(kernel);
    for (std::uint32_t done = 0; done < steps;) {
      for (std::uint32_t k = 0; k < perReadback && done < steps; ++k, ++done) {
        ++step_;
        kernel.setArg(stepArgument, step_);
        enqueue(kernel, items_);
      }
      cl_uint left[3];
      readBuffer<cl_uint>(device_, listCount_, left);
      step(progress, "grow", 0.0);
      if (left[(step_ + 1) % 3] == 0) break;
    }
  }

  void finish() { launch("flood_finish", items_); }

  Labels labels(std::size_t fracture) {
    Labels out;
    const std::size_t voxels = std::size_t{leafCount_} * SHERD_LEAF_SIZE;
    out.fragment.resize(voxels);
    readBuffer<std::uint16_t>(device_, owner_, out.fragment, fracture * voxels);
    if (keepCost_) {
      out.cost.resize(voxels);
      readBuffer<std::uint32_t>(device_, cost_, out.cost, fracture * voxels);
    }
    return out;
  }

 private:
  template <class T>
  cl::Buffer filled(std::size_t count, T value) {
    cl::Buffer buffer = makeBuffer<T>(device_, count);
    device_.queue.enqueueFillBuffer(buffer, value, 0, std::max<std::size_t>(count, 1) * sizeof(T));
    return buffer;
  }

  // Set the arguments FLOOD_STATE names, in its order; return the number of the next.
  cl_uint setState(cl::Kernel& kernel) {
    cl_uint i = 0;
    const auto set = [&](const auto&... argument) { (kernel.setArg(i++, argument), ...); };
    set(domain_, neighbour_, leafCount_, owned_, tag_, owner_, frontMask_, frontStep_, frontTag_,
        queued_, list_, listCount_, items_, cost_, static_cast<cl_uint>(keepCost_));
    return i;
  }

  template <class... Arguments>
  void launch(const char* name, std::size_t work, const Arguments&... arguments) {
    cl::Kernel kernel = device_.kernel("flood.cl", name);
    cl_uint i = setState(kernel);
    (kernel.setArg(i++, arguments), ...);
    enqueue(kernel, work);
  }

  void enqueue(cl::Kernel& kernel, std::size_t work) { device_.launch(kernel, work, group_); }

  Device::Impl& device_;
  cl_uint leafCount_, items_;
  std::size_t group_;
  bool keepCost_;
  cl_uint step_ = 0;
  cl::Buffer domain_, neighbour_, owned_, tag_, owner_, frontMask_, frontStep_, frontTag_, queued_,
      list_, listCount_, cost_;
};

}  // namespace

std::vector<Labels> grow(const LeafBlocks& blocks, std::span<const std::vector<Seed>> seedSets,
                         Device& device, const GrowOptions& options, const Progress* progress) {
  const SeedTable table = tableOf(blocks, seedSets);
  if (blocks.count() * seedSets.size() >= SHERD_NO_LEAF) {
    throw Error(ErrorCode::usage,
                "the batch holds " + std::to_string(blocks.count() * seedSets.size()) +
                    " leaves, at most " + std::to_string(SHERD_NO_LEAF - 1) + " can grow together");
  }
  Device::Impl& impl = device.impl();
  return withDevice(impl, "growing fragments", [&] {
    Flood flood(blocks, seedSets.size(), impl, options);
    const auto perReadback =
        static_cast<std::uint32_t>(options.stepsPerReadback > 0 ? options.stepsPerReadback : 16);
    flood.domain(blocks.inside);
    flood.seed(table);
    flood.grow(SHERD_NO_STEP, perReadback, progress);
    if (options.outerSteps > 0) {
      flood.domain(blocks.outerBand);
      flood.restart();
      flood.grow(static_cast<std::uint32_t>(options.outerSteps), perReadback, progress);
    }
    flood.finish();
    std::vector<Labels> all;
    for (std::size_t f = 0; f < seedSets.size(); ++f) all.push_back(flood.labels(f));
    return all;
  });
}

std::vector<std::uint64_t> countVoxels(const LeafBlocks& blocks, const Labels& labels,
                                       int fragments) {
  std::vector<std::uint64_t> counts(static_cast<std::size_t>(fragments) + 1);
  for (std::size_t word = 0; word < blocks.inside.size(); ++word) {
    for (std::uint64_t bits = blocks.inside[word]; bits; bits &= bits - 1) {
      ++counts[labels.fragment[word * 64 + static_cast<std::size_t>(std::countr_zero(bits))]];
    }
  }
  return counts;
}

}  // namespace sherd
