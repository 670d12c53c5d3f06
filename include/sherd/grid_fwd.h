// OpenVDB types used by the headers: openvdb::Coord, and a forward declaration of
// openvdb::FloatGrid, because including all of OpenVDB adds seconds to a compilation.  Include
// <openvdb/openvdb.h> where a grid's values are needed.
#pragma once

#include <openvdb/math/Coord.h>
#include <openvdb/version.h>

#include <cstdint>
#include <memory>

namespace openvdb {
OPENVDB_USE_VERSION_NAMESPACE
namespace OPENVDB_VERSION_NAME {
using math::Coord;
namespace tree {
template <typename T, std::uint32_t Log2Dim>
class LeafNode;
template <typename ChildNode, std::uint32_t Log2Dim>
class InternalNode;
template <typename ChildNode>
class RootNode;
template <typename Root>
class Tree;
}  // namespace tree
template <typename Tree>
class Grid;
using FloatTree = tree::Tree<
    tree::RootNode<tree::InternalNode<tree::InternalNode<tree::LeafNode<float, 3>, 4>, 5>>>;
using FloatGrid = Grid<FloatTree>;
}  // namespace OPENVDB_VERSION_NAME
}  // namespace openvdb

namespace sherd {

/// A grid, read-only once returned.
using ConstFloatGridPtr = std::shared_ptr<const openvdb::FloatGrid>;

}  // namespace sherd
