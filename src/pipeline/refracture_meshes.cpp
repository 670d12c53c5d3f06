// Exact meshes of a fracture that is broken again.
#include "pipeline/refracture_meshes.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/Morphology.h>

#include <algorithm>
#include <array>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>

#include "cut/label_reader.h"
#include "mesh/positions.h"
#include "surface/exact/body_clusters.h"
#include "surface/exact/exact_by_cluster.h"
#include "surface/exact/settled_labels.h"
#include "voxelize/leaves/leaf_blocks.h"

namespace sherd {
namespace {

// A face's neighbor is searched among the voxels around it, up to so many away.
constexpr int kReach = 3;

// Returns [faces] whether each corner is at a vertex of another fragment: the face is on a crack
// that is closed.  The face itself need not be another fragment's: where that was broken again, it
// has parts of the face, whose new corners are those of its own parts.
std::vector<bool> areShared(const FinishedFracture& finished) {
  constexpr std::uint32_t kNone = 0, kSeveral = std::numeric_limits<std::uint32_t>::max();
  const std::vector<std::uint32_t> at = firstAtPosition(finished.faces.vertices);
  std::vector<std::uint32_t> fragmentOf(at.size(), kNone);  // that has a vertex there
  const auto forEachFace = [&](const auto& visit) {
    for (std::uint32_t id = 1; id < finished.firstFace.size(); ++id) {
      for (std::size_t t = finished.firstFace[id - 1]; t < finished.firstFace[id]; ++t)
        visit(id, finished.faces.triangles[t]);
    }
  };
  forEachFace([&](std::uint32_t id, const glm::uvec3& face) {
    for (int k = 0; k < 3; ++k) {
      std::uint32_t& known = fragmentOf[at[face[k]]];
      known = known == kNone || known == id ? id : kSeveral;
    }
  });
  std::vector<bool> areShared;
  forEachFace([&](std::uint32_t, const glm::uvec3& face) {
    areShared.push_back(fragmentOf[at[face.x]] == kSeveral && fragmentOf[at[face.y]] == kSeveral &&
                        fragmentOf[at[face.z]] == kSeveral);
  });
  return areShared;
}

// Returns the pairs of labels, the lower one first, whose inside voxels share a face.
std::set<std::pair<std::uint16_t, std::uint16_t>> touchingPairs(const Labels& labels) {
  const LeafBlocks& blocks = *labels.blocks;
  std::set<std::pair<std::uint16_t, std::uint16_t>> pairs;
  blocks.forEachInside([&](std::size_t voxel) {
    const std::uint16_t own = labels.fragment[voxel];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::size_t next = voxelBehind(blocks, voxel, axis);
      if (next == kNoVoxel) continue;
      const std::uint16_t other = labels.fragment[next];
      if (other != own && blocks.isInside(next)) pairs.insert(std::minmax(own, other));
    }
  });
  return pairs;
}

// Finds the new neighbors of faces.
class Neighbors {
 public:
  Neighbors(const FinishedFracture& finished, std::span<const BrokenFragment> broken,
            const Labels& labels)
      : faces_(finished.faces),
        areShared_(areShared(finished)),
        frame_(finished.solid.frame),
        labels_(*labels.blocks, labels),
        touching_(touchingPairs(labels)),
        parts_(static_cast<std::size_t>(finished.labels.fragmentCount) + 1) {
    for (const BrokenFragment& one : broken) parts_[static_cast<std::size_t>(one.id)] = one.ids;
  }

  // Returns the new neighbor of a face, or of a part of one: of the parts of a broken fragment the
  // nearest.  Withheld fragments are no longer there, and what an erosion has taken from between
  // two fragments is outside of the solid: such faces have no neighbor any more.
  //   own   the new fragment
  //   face  in FinishedFracture::faces
  std::uint16_t of(std::size_t own, std::size_t face, const glm::dvec3& centroid) {
    const std::uint16_t old = faces_.neighbor[face];
    if (old >= parts_.size() || old == 0) return 0;
    const std::uint16_t found = parts_[old].empty() ? old : nearestOf(parts_[old], centroid);
    const auto id = static_cast<std::uint16_t>(own);
    return areShared_[face] || touching_.contains(std::minmax(id, found)) ? found
                                                                          : std::uint16_t{0};
  }

 private:
  static constexpr int kSide = 2 * kReach + 1;

  // Returns which of a broken fragment's parts has the nearest voxel within kReach; without one the
  // first.
  std::uint16_t nearestOf(std::span<const std::uint16_t> parts, const glm::dvec3& centroid) {
    const glm::dvec3 at = frame_.indexFromWorld(centroid);
    const glm::dvec3 middle = glm::round(at);
    double least = std::numeric_limits<double>::infinity();
    std::uint16_t nearest = parts[1];
    for (int k = 0; k < kSide * kSide * kSide; ++k) {
      const glm::dvec3 voxel =
          middle + glm::dvec3(k / (kSide * kSide), k / kSide % kSide, k % kSide) - double{kReach};
      const double squared = glm::dot(voxel - at, voxel - at);
      if (squared >= least) continue;
      const std::uint16_t label = labels_.at(openvdb::Coord(openvdb::Vec3i(
          static_cast<int>(voxel.x), static_cast<int>(voxel.y), static_cast<int>(voxel.z))));
      if (!std::binary_search(parts.begin() + 1, parts.end(), label)) continue;
      least = squared;
      nearest = label;
    }
    return nearest;
  }

  const TriangleMesh& faces_;
  const std::vector<bool> areShared_;
  const GridFrame frame_;
  LabelReader labels_;
  const std::set<std::pair<std::uint16_t, std::uint16_t>> touching_;
  std::vector<std::vector<std::uint16_t>> parts_;  // [old] BrokenFragment::ids, else empty
};

glm::dvec3 centroidOf(const TriangleMesh& mesh, std::size_t t) {
  const glm::uvec3& corner = mesh.triangles[t];
  return (mesh.vertices[corner.x] + mesh.vertices[corner.y] + mesh.vertices[corner.z]) / 3.0;
}

// Returns TriangleMesh::source of a face, or of a part of one.
std::uint32_t sourceOf(const FinishedFracture& finished, std::size_t face, std::uint16_t neighbor) {
  if (neighbor != 0 || face >= finished.sourceOf.size()) return TriangleMesh::kNoSource;
  return finished.sourceOf[face];
}

// A fragment that stays.
LabeledMesh keptMesh(const FinishedFracture& finished, int id, Neighbors& neighbors) {
  SolidMesh own = meshOf(finished, id);
  LabeledMesh out{.mesh = std::move(own.mesh)};
  for (std::size_t t = 0; t < own.source.size(); ++t) {
    out.other.push_back(
        neighbors.of(static_cast<std::size_t>(id), own.source[t], centroidOf(out.mesh, t)));
    out.mesh.source.push_back(sourceOf(finished, own.source[t], out.other.back()));
  }
  return out;
}

// Gives the parts of faces that were cracks before their new neighbors.
//   ids  BrokenFragment::ids
void setNeighbors(const FinishedFracture& finished, std::span<const std::uint16_t> ids,
                  std::size_t own, Neighbors& neighbors, LabeledMesh& part) {
  for (std::size_t t = 0; t < part.other.size(); ++t) {
    std::uint32_t& source = part.mesh.source[t];
    if (source == TriangleMesh::kNoSource) {  // a new crack
      part.other[t] = ids[part.other[t]];
      continue;
    }
    part.other[t] = neighbors.of(own, source, centroidOf(part.mesh, t));
    source = sourceOf(finished, source, part.other[t]);
  }
}

// A broken fragment that could not be cut.
struct Failed {
  std::uint16_t first = 0;  // id of a part
  std::string reason{};
};

// Removes the meshes of fragments that are connected with those that could not be cut: smooth
// surfaces of their neighbors would not fit them.
ExactSurface withoutFailed(ExactSurface all, const std::vector<Failed>& failed,
                           const Labels& labels) {
  const std::vector<std::uint32_t> set = connectedFragments(labels);
  std::map<std::uint32_t, SmoothBodies> smooth;  // by names of sets
  for (const Failed& one : failed) {
    smooth.try_emplace(set[one.first - 1u], SmoothBodies{.reason = one.reason});
  }
  std::size_t count = 0;
  for (std::size_t i = 0; i < all.meshes.size(); ++i) {
    const auto found = smooth.find(set[i]);
    if (found == smooth.end()) continue;
    found->second.fragments.push_back(static_cast<int>(i + 1));
    all.meshes[i] = {};
    ++count;
  }
  if (count == all.meshes.size()) return {.failure = failed.front().reason};
  for (auto& [name, bodies] : smooth) all.smooth.push_back(std::move(bodies));
  return all;
}

}  // namespace

SolidMesh meshOf(const FinishedFracture& finished, int id) {
  if (finished.firstFace.empty()) return {};
  const auto begin = finished.firstFace[static_cast<std::size_t>(id) - 1];
  const auto end = finished.firstFace[static_cast<std::size_t>(id)];
  SolidMesh out;
  if (begin == end) return out;
  // A fragment's vertices are consecutive.
  std::uint32_t low = std::numeric_limits<std::uint32_t>::max(), high = 0;
  for (std::size_t t = begin; t < end; ++t) {
    const glm::uvec3& corner = finished.faces.triangles[t];
    low = std::min({low, corner.x, corner.y, corner.z});
    high = std::max({high, corner.x, corner.y, corner.z});
  }
  const auto vertices = finished.faces.vertices.begin();
  out.mesh.vertices.assign(vertices + low, vertices + high + 1);
  for (std::size_t t = begin; t < end; ++t) {
    out.mesh.triangles.push_back(finished.faces.triangles[t] - low);
    out.source.push_back(static_cast<std::uint32_t>(t));
  }
  return out;
}

void setExteriorBand(LeafBlocks& blocks) {
  using Word = std::uint64_t;
  openvdb::MaskTree band;
  for (std::size_t leaf = 0; leaf < blocks.count(); ++leaf) {
    openvdb::MaskTree::LeafNodeType::NodeMaskType mask;
    for (openvdb::Index32 w = 0; w < 8; ++w) mask.getWord<Word>(w) = blocks.inside[leaf * 8 + w];
    if (mask.isOff()) continue;
    band.touchLeaf(blocks.origins[leaf])->setValueMask(mask);
  }
  // No leaf becomes a tile, even where all voxels are reached.
  openvdb::tools::dilateActiveValues(band, kHalfWidthVoxels, openvdb::tools::NN_FACE_EDGE,
                                     openvdb::tools::IGNORE_TILES);
  for (std::size_t leaf = 0; leaf < blocks.count(); ++leaf) {
    const auto* const found = band.probeConstLeaf(blocks.origins[leaf]);
    for (openvdb::Index32 w = 0; w < 8; ++w) {
      const Word reached = found == nullptr ? 0 : found->getValueMask().getWord<Word>(w);
      blocks.exteriorBand[leaf * 8 + w] = reached & ~blocks.inside[leaf * 8 + w];
    }
  }
}

void cutAgain(const FinishedFracture& finished, BrokenFragment& broken, double adaptivity,
              const Progress* progress) {
  auto mesh = std::make_shared<const SolidMesh>(meshOf(finished, broken.id));
  if (mesh->mesh.triangles.empty()) {
    broken.surface.failure = "it has no mesh";
    return;
  }
  Solid solid = broken.solid;
  solid.report.fill = Fill::winding;
  solid.report.defects.components = meshComponents(mesh->mesh).count;
  solid.mesh = std::move(mesh);
  const std::vector<LeafNeighbors> neighborhoods = leafNeighbors(solid.blocks->origins);
  broken.surface = settledExactMeshes(solid, broken.labels, nullptr, kSmallComponentVoxels,
                                      neighborhoods, adaptivity, progress);
}

ExactSurface exactMeshesAgain(const FinishedFracture& finished, std::span<BrokenFragment> broken,
                              const Labels& labels) {
  if (finished.firstFace.empty()) {
    return {.failure = "the fracture was written without meshes whose neighbors are known"};
  }
  Neighbors neighbors(finished, broken, labels);
  ExactSurface all;
  all.meshes.resize(static_cast<std::size_t>(labels.fragmentCount));
  std::vector<bool> isKept(static_cast<std::size_t>(finished.labels.fragmentCount) + 1, true);
  for (const BrokenFragment& one : broken) isKept[static_cast<std::size_t>(one.id)] = false;
  for (int id = 1; id <= finished.labels.fragmentCount; ++id) {
    const auto at = static_cast<std::size_t>(id);
    if (isKept[at]) all.meshes[at - 1] = keptMesh(finished, id, neighbors);
  }
  std::vector<Failed> failed;
  for (BrokenFragment& one : broken) {
    ExactSurface parts = std::move(one.surface);
    if (parts.failure.empty() && !parts.smooth.empty()) parts.failure = parts.smooth.front().reason;
    if (!parts.failure.empty()) {
      failed.push_back({one.ids[1], "fragment " + std::to_string(one.id) + ": " + parts.failure});
      continue;
    }
    for (std::size_t part = 0; part < parts.meshes.size(); ++part) {
      const std::uint16_t own = one.ids[part + 1];
      setNeighbors(finished, one.ids, own, neighbors, parts.meshes[part]);
      all.meshes[own - 1u] = std::move(parts.meshes[part]);
    }
  }
  setPositions(all.meshes);
  return failed.empty() ? std::move(all) : withoutFailed(std::move(all), failed, labels);
}

}  // namespace sherd
