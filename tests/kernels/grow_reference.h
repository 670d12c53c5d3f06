// Plain references for growth: maps and queues, one voxel at a time.
#pragma once

#include <sherd/labels.h>

#include <functional>
#include <map>
#include <vector>

#include "voxel_shapes.h"

namespace sherd::reference {

using Coord = openvdb::Coord;
using LabelMap = std::map<Coord, std::uint16_t>;

struct Arrival {
  std::uint64_t cost;
  std::uint16_t label;
};

/// Squared euclidean, chebyshev or manhattan distance.
std::uint64_t distance(Metric metric, const Coord& a, const Coord& b);

/// Nearest seed of every inside voxel by trying them all; ties to the lower label.
std::map<Coord, Arrival> nearest(const voxel_shapes::VoxelSolid& solid,
                                 const std::vector<Seed>& seeds, Metric metric);

/// A step to a neighbour, its cost, and what else must be inside for it.
struct Step {
  Coord to;
  std::uint64_t weight;
  std::vector<Coord> over;
};
std::vector<Step> moore();    ///< 26 steps of weight 1
std::vector<Step> chamfer();  ///< 98 steps, 16 a voxel

/// Dijkstra from labelled voxels by (cost, label).
std::map<Coord, Arrival> dijkstra(const std::set<Coord>& inside, const LabelMap& start,
                                  const std::vector<Step>& steps);

/// What hangs together over faces with its fragment's first seed.
LabelMap kept(const LabelMap& labels, const std::vector<Seed>& seeds);

/// Number of 6-connected parts of equal label.
std::size_t connectedParts(const LabelMap& labels);

/// The labels of inside voxels as a map; voxels of label 0 are left out.
LabelMap mapOf(const LeafBlocks& blocks, const Labels& labels);

}  // namespace sherd::reference
