// The 6-connected parts of the inside.  The method is described in kernels/components.cl.
#include <sherd/seeds.h>

#include <bit>

#include "cl/device_impl.h"
#include "leaf_block.h"

namespace sherd {
namespace {

// Voxels of each part, and the parts numbered by their lowest node: nodes ascend with leaves and
// voxels.
void numberParts(const LeafBlocks& blocks, std::span<const cl_uint> nodeCount,
                 std::span<const cl_uint> root, Parts& parts) {
  parts.partOfNode.resize(root.size());
  for (std::size_t n = 0; n < root.size(); ++n) {
    if (root[n] == n) {
      parts.partOfNode[n] = static_cast<std::uint32_t>(parts.voxels.size());
      parts.voxels.push_back(0);
    } else {
      parts.partOfNode[n] = parts.partOfNode[root[n]];  // a root is lower than its nodes
    }
  }
  for (std::size_t leaf = 0; leaf < blocks.count(); ++leaf) {
    for (std::size_t x = 0; x < SHERD_LEAF_WORDS; ++x) {
      std::uint64_t bits = blocks.inside[leaf * SHERD_LEAF_WORDS + x];
      if (nodeCount[leaf] == 1) {
        parts.voxels[parts.partOfNode[parts.firstNode[leaf]]] +=
            static_cast<std::uint64_t>(std::popcount(bits));
        continue;
      }
      for (; bits; bits &= bits - 1) {
        ++parts.voxels[parts.at(leaf, static_cast<std::uint32_t>(x * 64) +
                                          static_cast<std::uint32_t>(std::countr_zero(bits)))];
      }
    }
  }
}

}  // namespace

Parts findParts(const LeafBlocks& blocks, Device& device) {
  Device::Impl& impl = device.impl();
  return withDevice(impl, "finding connected parts", [&] {
    const auto leafCount = static_cast<cl_uint>(blocks.count());
    const auto run = [&](const char* name, std::size_t work, const auto&... arguments) {
      cl::Kernel kernel = impl.kernel("components.cl", name);
      cl_uint i = 0;
      (kernel.setArg(i++, arguments), ...);
      impl.launch(kernel, work, impl.workGroupSize());
    };

    const cl::Buffer inside = uploadBuffer<std::uint64_t>(impl, blocks.inside);
    const cl::Buffer neighbour = uploadBuffer<std::uint32_t>(impl, blocks.neighbours);
    const cl::Buffer localNode = makeBuffer<cl_uchar>(impl, blocks.count() * SHERD_LEAF_SIZE);
    const cl::Buffer counts = makeBuffer<cl_uint>(impl, blocks.count());
    run("component_nodes", blocks.count(), inside, leafCount, localNode, counts);

    Parts parts;
    parts.localNode.resize(blocks.count() * SHERD_LEAF_SIZE);
    std::vector<cl_uint> nodeCount(blocks.count());
    readBuffer<std::uint8_t>(impl, localNode, parts.localNode);
    readBuffer<cl_uint>(impl, counts, nodeCount);
    cl_uint nodes = 0;
    for (const cl_uint n : nodeCount) {
      parts.firstNode.push_back(nodes);
      nodes += n;
    }

    const cl::Buffer firstNode = uploadBuffer<std::uint32_t>(impl, parts.firstNode);
    const cl::Buffer parent = makeBuffer<cl_uint>(impl, nodes);
    const cl::Buffer rootBuffer = makeBuffer<cl_uint>(impl, nodes);
    run("component_begin", nodes, nodes, parent);
    run("component_join", blocks.count(), inside, neighbour, localNode, firstNode, leafCount,
        parent);
    run("component_flatten", nodes, nodes, parent, rootBuffer);
    std::vector<cl_uint> root(nodes);
    readBuffer<cl_uint>(impl, rootBuffer, root);
    numberParts(blocks, nodeCount, root, parts);
    return parts;
  });
}

}  // namespace sherd
