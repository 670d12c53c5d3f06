// The outermost layer of a fragment's voxels, by OpenVDB's morphology.
#include "erode/shell.h"

#include <openvdb/tools/Morphology.h>
#include <sherd/error.h>

#include <memory>
#include <string>

namespace sherd {
namespace {

// Nodes 64 voxels wide: clearing those of MaskTree, 4096 wide, takes longer than eroding a small
// fragment.
using ShellTree = openvdb::tree::Tree3<openvdb::ValueMask, 3, 3>::Type;
using ShellLeaf = ShellTree::LeafNodeType;

// Fewer leaves than this are faster without threads.
constexpr std::size_t kThreadedLeaves = 256;

}  // namespace

std::vector<LeafMask> shellOf(const FragmentMasks& fragment) {
  ShellTree tree;
  std::vector<const ShellLeaf*> leaves;
  for (std::size_t i = 0; i < fragment.masks.size(); ++i) {
    auto leaf = std::make_unique<ShellLeaf>(fragment.origins[i], false, false);
    for (openvdb::Index x = 0; x < 8; ++x) {
      leaf->getValueMask().getWord<std::uint64_t>(x) = fragment.masks[i][x];
    }
    leaves.push_back(leaf.get());
    tree.addLeaf(leaf.release());
  }
  try {
    openvdb::tools::erodeActiveValues(tree, 1, openvdb::tools::NN_FACE_EDGE_VERTEX,
                                      openvdb::tools::IGNORE_TILES,
                                      leaves.size() >= kThreadedLeaves);
  } catch (const openvdb::Exception& e) {
    throw Error(ErrorCode::internal, std::string("erode: OpenVDB failed: ") + e.what());
  }
  std::vector<LeafMask> shell(leaves.size());
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    for (openvdb::Index x = 0; x < 8; ++x) {
      shell[i][x] = fragment.masks[i][x] & ~leaves[i]->getValueMask().getWord<std::uint64_t>(x);
    }
  }
  return shell;
}

}  // namespace sherd
