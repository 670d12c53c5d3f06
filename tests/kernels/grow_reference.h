// Reference implementations of growth: maps and queues, one voxel at a time.
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

/// Seeds of which those move to their voxels' centers that have another fragment's seed nearer to
/// it, until there are none; all move after eight passes.
std::vector<Seed> settled(std::vector<Seed> seeds, Metric metric);

/// Nearest point of a seed from every inside voxel by brute force; ties to the lower label.  The
/// cost is the distance in voxels, squared if Euclidean, rounded down.
std::map<Coord, Arrival> nearest(const voxel_shapes::VoxelSolid& solid,
                                 const std::vector<Seed>& seeds, Metric metric);

/// The same from where ways lead from each voxel, in steps of seeds, by Euclidean distances to
/// seeds that are settled.
std::map<Coord, Arrival> nearestInWalls(const voxel_shapes::VoxelSolid& solid,
                                        const std::vector<Seed>& settledSeeds,
                                        const std::function<glm::ivec3(const Coord&)>& wayOf);

struct Step {
  Coord to;  ///< offset
  std::uint64_t weight;
  std::vector<Coord> over;  ///< offsets of voxels that must be inside too
};
std::vector<Step> moore();    ///< 26 steps of weight 1
std::vector<Step> chamfer();  ///< 98 steps, 16 a voxel

/// Dijkstra from labeled voxels by (cost, label).
std::map<Coord, Arrival> dijkstra(const std::set<Coord>& inside, const LabelMap& start,
                                  const std::vector<Step>& steps);

/// The voxels that are 6-connected to their fragment's first seed.
LabelMap kept(const LabelMap& labels, const std::vector<Seed>& seeds);

/// Number of 6-connected components of equal label.
std::size_t countConnectedComponents(const LabelMap& labels);

/// The labels of inside voxels as a map, without those of label 0.
LabelMap mapOf(const Labels& labels);

}  // namespace sherd::reference
