// Extracts fragments, one batch at a time.
#include "surface/extract.h"

#include <sherd/error.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <bit>
#include <glm/geometric.hpp>
#include <string>
#include <utility>

#include "base/cancel_flag.h"
#include "base/uncancelled.h"
#include "grow/check_labels.h"
#include "surface/decimate.h"
#include "surface/exact_meshes.h"
#include "surface/independent_cracks.h"
#include "surface/independent_mesh.h"
#include "surface/intact.h"
#include "surface/intact_labels.h"
#include "surface/label_mesh.h"
#include "surface/leaf_labels.h"
#include "surface/level_set.h"
#include "surface/seam_charts.h"
#include "surface/seam_cuts.h"
#include "surface/smooth.h"
#include "voxelize/leaf_blocks.h"

namespace sherd {
namespace {

// [fragments + 1] the leaves that hold a fragment, and by CutExtent::everywhere all within two
// voxels of it, ascending.
std::vector<std::vector<std::uint32_t>> leavesOf(const Cut& cut, std::size_t fragments) {
  std::vector<std::vector<std::uint32_t>> leaves(fragments + 1);
  for (std::uint32_t leaf = 0; leaf < cut.only.size(); ++leaf) {
    const auto add = [&](std::uint16_t fragment) {
      if (fragment != Labels::kEroded) leaves[fragment].push_back(leaf);
    };
    if (cut.index[leaf] == Cut::kWhole) {
      add(cut.only[leaf]);
    } else {
      for (const std::uint16_t fragment : cut.leaves[cut.index[leaf]].fragments) add(fragment);
    }
  }
  return leaves;
}

// [fragments + 1] the boxes of their inside voxels.
std::vector<VoxelBox> voxelBoxes(const LeafBlocks& blocks, const Labels& labels) {
  const auto end = static_cast<std::size_t>(labels.fragmentCount) + 1;
  std::vector<VoxelBox> boxes(end, VoxelBox{openvdb::Coord::max(), openvdb::Coord::min()});
  const auto widen = [](VoxelBox& box, const openvdb::Coord& low, const openvdb::Coord& high) {
    box.min.minComponent(low);
    box.max.maxComponent(high);
  };
  for (std::size_t leaf = 0; leaf < blocks.count(); ++leaf) {
    const std::span<const std::uint16_t> own(&labels.fragment[leaf * 512], 512);
    const openvdb::Coord& origin = blocks.origins[leaf];
    const bool isWhole = std::all_of(&blocks.inside[leaf * 8], &blocks.inside[leaf * 8] + 8,
                                     [](std::uint64_t bits) { return ~bits == 0; });
    if (const LabelRange range = rangeOf(own); isWhole && range.isOne() && range.high < end) {
      widen(boxes[range.high], origin, origin + openvdb::Coord(7));
      continue;
    }
    for (std::size_t x = 0; x < 8; ++x) {
      for (std::uint64_t bits = blocks.inside[leaf * 8 + x]; bits; bits &= bits - 1) {
        const auto v =
            static_cast<std::uint32_t>(x * 64) + static_cast<std::uint32_t>(std::countr_zero(bits));
        if (own[v] >= end) continue;
        const openvdb::Coord voxel = origin + coordFromOffset(v);
        widen(boxes[own[v]], voxel, voxel);
      }
    }
  }
  return boxes;
}

// Sets the areas of the whole surface and of the fracture surface.
void measureAreas(Fragment& fragment) {
  double twice = 0.0, twiceFractured = 0.0;
  for (std::size_t t = 0; t < fragment.mesh.triangles.size(); ++t) {
    const glm::uvec3& corner = fragment.mesh.triangles[t];
    const glm::dvec3& a = fragment.mesh.vertices[corner.x];
    const double own = glm::length(
        glm::cross(fragment.mesh.vertices[corner.y] - a, fragment.mesh.vertices[corner.z] - a));
    twice += own;
    if (fragment.mesh.neighbor[t] != 0) twiceFractured += own;
  }
  fragment.area = twice / 2.0;
  fragment.fractureArea = twiceFractured / 2.0;
}

// [triangles] true on the solid's surface.
std::vector<bool> onSolid(const LabeledMesh& mesh) {
  std::vector<bool> original;
  for (const std::uint16_t other : mesh.other) original.push_back(other == 0);
  return original;
}

// With independent interfaces each fragment is meshed alone, with the leaves around it.  Exact
// surfaces may fail, and become what the other options say.
bool needsWholeCut(const SurfaceOptions& surface) {
  return surface.levelSets ||
         (surface.surface != Surface::labels && surface.interface == Interface::independent);
}

const SurfaceOptions& checked(const Solid& solid, const ExtractOptions& options,
                              const Progress* progress) {
  checkSurfaceOptions(options.surface);
  if (options.uneroded != nullptr) checkLabels(*options.uneroded, solid);
  checkIntact(options.intact, solid);
  reportProgress(progress, "extract", 0.0);
  return options.surface;
}

}  // namespace

Extraction::Extraction(const Solid& solid, const Labels& labels, const ExtractOptions& options,
                       const Progress* progress)
    : solid_(solid),
      labels_(labels),
      uneroded_(options.uneroded),
      surface_(checked(solid, options, progress)),
      progress_(progress),
      seed_(options.seed),
      count_(static_cast<std::size_t>(labels.fragmentCount)),
      voxels_(checkedCounts(labels, solid)),
      boxes_(voxelBoxes(*solid.blocks, labels)),
      ownNeighborhoods_(options.intact ? std::vector<LeafNeighbors>()
                                       : leafNeighbors(solid.blocks->origins)),
      neighborhoods_(options.intact ? options.intact->neighborhoods : ownNeighborhoods_),
      cut_(findCut(labels, neighborhoods_,
                   needsWholeCut(surface_) ? CutExtent::everywhere : CutExtent::cells, progress)),
      leaves_(leavesOf(cut_, count_)) {
  if (surface_.surface == Surface::exact) {
    makeExact(options.exact ? *options.exact
                            : exactMeshes(solid_, labels_, neighborhoods_, progress_));
  }
  if (surface_.surface != Surface::smooth) return;
  if (!options.intact) ownCreases_ = Creases(solid, neighborhoods_, progress);
  creases_ = options.intact ? &options.intact->creases : &ownCreases_;
  simplification_ = simplificationOf(surface_, solid, options.intact);
  if (!isShared()) return;
  shared_.emplace(solid, labels, cut_, neighborhoods_, *creases_, options.intact, progress);
  const bool isProcessed = simplification_.isAny() || !surface_.triangles.empty() ||
                           movesAnything(surface_.smooth, solid.box.longestSide());
  if (!isProcessed) return;
  processTogether();
}

bool Extraction::isShared() const {
  return surface_.surface == Surface::smooth && surface_.interface == Interface::shared;
}

void Extraction::makeExact(ExactSurface exact) {
  if (!exact.failure.empty()) {
    exactFailure_ = std::move(exact.failure);
    surface_.surface = Surface::smooth;
    return;
  }
  for (std::size_t i = 0; i < count_; ++i) {
    LabeledMesh& mesh = exact.meshes[i];
    mesh.mesh.neighbor = mesh.other;
    if (!uneroded_) continue;
    std::vector<bool> original;
    for (const std::uint32_t source : mesh.mesh.source)
      original.push_back(source != TriangleMesh::kNoSource);
    mesh.mesh.neighbor = neighborsOf(mesh.mesh, original, static_cast<std::uint16_t>(i + 1), solid_,
                                     *uneroded_, true);
  }
  if (!surface_.triangles.empty()) {
    processed_.coarse = decimated(complexOf(exact.meshes), surface_.triangles, progress_);
  }
  processed_.meshes = std::move(exact.meshes);
}

LabeledMesh Extraction::sharedMesh(int id) const {
  LabeledMesh mesh = shared_->meshOf(id);
  mesh.mesh.neighbor = uneroded_
                           ? neighborsOf(mesh.mesh, onSolid(mesh), static_cast<std::uint16_t>(id),
                                         solid_, *uneroded_, true)
                           : mesh.other;
  return mesh;
}

// Frees what is not needed any more before the next step, which takes about as much memory.
void Extraction::processTogether() {
  Processed& all = processed_;
  all.meshes.resize(count_);
  CancelFlag stop(progress_);
  tbb::parallel_for(std::size_t{0}, count_, [&](std::size_t i) {
    if (!stop.isSet()) all.meshes[i] = sharedMesh(static_cast<int>(i) + 1);
  });
  stop.throwIfSet();
  shared_.reset();
  smoothTogether(all.meshes, surface_.smooth, solid_.box.longestSide(), progress_);
  throwIfCancelled(progress_);
  if (solid_.seams) all.cutFaces = cutTogether(all.meshes, *solid_.seams, solid_.frame);
  if (simplification_.isAny()) {
    all.cutFaces.clear();
    Complex complex = complexOf(std::exchange(all.meshes, {}));
    all.meshes = simplified(std::move(complex), simplification_, progress_);
  }
  if (!surface_.triangles.empty()) {
    all.coarse = decimated(complexOf(all.meshes), surface_.triangles, progress_);
  }
}

void Extraction::meshShared(Fragment& fragment) {
  const std::size_t i = static_cast<std::size_t>(fragment.id) - 1;
  if (shared_) {
    fragment.mesh = std::move(sharedMesh(fragment.id).mesh);
    cutSeams(fragment);
    return;
  }
  fragment.mesh = std::move(processed_.meshes[i].mesh);
  if (!processed_.cutFaces.empty()) fragment.cutFaces = std::move(processed_.cutFaces[i]);
  if (!processed_.coarse.empty()) fragment.coarse = std::move(processed_.coarse[i]);
}

// Cuts a fragment's mesh along the seams of the input's attributes.
void Extraction::cutSeams(Fragment& fragment) const {
  if (!solid_.seams) return;
  SeamCutMesh cut = cutAlong(std::move(fragment.mesh), *solid_.seams, solid_.frame);
  fragment.mesh = std::move(cut.mesh);
  fragment.cutFaces = std::move(cut.faces);
}

void Extraction::meshIndependent(Fragment& fragment) const {
  const auto id = static_cast<std::uint16_t>(fragment.id);
  const std::vector<std::uint32_t>& leaves = leaves_[id];
  const Labels& before = uneroded_ ? *uneroded_ : labels_;
  const FragmentKey key{seed_, id};
  if (surface_.surface == Surface::labels) {
    fragment.mesh = meshOfFaces(facesOf(solid_, labels_, before, id, leaves), solid_.frame);
  } else {
    LabeledMesh meshed = meshOfOne(solid_, labels_, cut_, *creases_, id, leaves);
    meshed.mesh.neighbor =
        neighborsOf(meshed.mesh, onSolid(meshed), id, solid_, before, uneroded_ != nullptr);
    slideCracks(meshed, solid_.frame, key);
    // Planes are merged first: they would no longer be planes.
    if (!simplification_.isAny()) jitterCracks(meshed.mesh, solid_.frame, key);
    fragment.mesh = std::move(meshed.mesh);
  }
  fragment.mesh =
      smoothed(std::move(fragment.mesh), surface_.smooth, solid_.box.longestSide(), progress_);
  if (surface_.surface == Surface::smooth) cutSeams(fragment);
  std::vector<std::uint32_t> charts;
  const bool isSimplified = simplification_.isAny() || !surface_.triangles.empty();
  if (isSimplified && solid_.seams && surface_.surface == Surface::smooth)
    charts = seamCharts(fragment.mesh, *solid_.seams, solid_.frame);
  if (simplification_.isAny()) {
    fragment.cutFaces.clear();
    LabeledMesh simple =
        std::move(simplified(complexOf(fragment.mesh, charts), simplification_, progress_).front());
    fragment.mesh = std::move(simple.mesh);
    charts = std::move(simple.chart);
    jitterCracks(fragment.mesh, solid_.frame, key);
  }
  fragment.coarse =
      std::move(decimated(complexOf(fragment.mesh, charts), surface_.triangles, progress_).front());
}

Fragment Extraction::makeFragment(std::size_t i) {
  Fragment fragment;
  fragment.id = static_cast<int>(i) + 1;
  const auto id = static_cast<std::uint16_t>(fragment.id);
  fragment.voxels = voxels_[i + 1];
  fragment.voxelBox = boxes_[i + 1];
  if (surface_.levelSets) fragment.surface = fragmentLevelSet(solid_, cut_, id, leaves_[id]);
  const bool isExact = surface_.surface == Surface::exact;
  isShared() || isExact ? meshShared(fragment) : meshIndependent(fragment);
  fragment.meshedAs = surface_.surface;
  fragment.mass = massProperties(fragment.mesh);
  measureAreas(fragment);
  return fragment;
}

// As many large fragments as threads, to limit memory; more small ones, so that the overhead of a
// batch does not dominate.
std::size_t Extraction::endOfBatch() const {
  constexpr std::size_t kLeaves = 4096;
  // Size of a level set's two internal nodes, in leaves.
  constexpr std::size_t kTreeOverhead = 128;
  const auto threads = static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
  std::size_t end = next_, leaves = 0;
  while (end < count_ && (end - next_ < threads || leaves < kLeaves)) {
    leaves += leaves_[++end].size() + (surface_.levelSets ? kTreeOverhead : 0);
  }
  return end;
}

std::vector<Fragment> Extraction::next() {
  const std::size_t begin = next_;
  next_ = endOfBatch();
  std::vector<Fragment> fragments(next_ - begin);
  CancelFlag stop(progress_);
  tbb::parallel_for(begin, next_, [&](std::size_t i) {
    if (!stop.isSet()) uncancelled([&] { fragments[i - begin] = makeFragment(i); });
  });
  stop.throwIfSet();
  for (const Fragment& fragment : fragments) measure_.add(fragment);
  reportProgress(progress_, "extract", static_cast<double>(next_) / static_cast<double>(count_));
  return fragments;
}

std::vector<std::vector<Contact>> Extraction::contacts() const {
  return measure_.contacts(count_, solid_, uneroded_ ? *uneroded_ : labels_, cut_, neighborhoods_);
}

std::vector<Fragment> measuredFragments(const FragmentSurfaces& surfaces, const Solid& solid,
                                        const Labels& labels, const Labels* uneroded,
                                        const Progress* progress) {
  const std::vector<std::uint64_t> voxels = checkedCounts(labels, solid);
  const std::vector<VoxelBox> boxes = voxelBoxes(*solid.blocks, labels);
  std::vector<std::vector<Contact>> contacts =
      surfaces.contacts(solid, uneroded ? *uneroded : labels);
  std::vector<Fragment> all(surfaces.count());
  CancelFlag stop(progress);
  tbb::parallel_for(std::size_t{0}, all.size(), [&](std::size_t i) {
    if (stop.isSet()) return;
    all[i] = surfaces.measured(static_cast<std::uint16_t>(i + 1));
    all[i].voxels = voxels[i + 1];
    all[i].voxelBox = boxes[i + 1];
    all[i].contacts = std::move(contacts[i]);
  });
  stop.throwIfSet();
  return all;
}

ExtractedFragments extractAll(const Solid& solid, const Labels& labels,
                              const ExtractOptions& options, const Progress* progress) {
  if (!options.surface.meshes) {
    (void)checked(solid, options, progress);
    // Shares nothing: the surface outlives the call.
    const std::shared_ptr<const IntactSurface> intact(std::shared_ptr<void>(), options.intact);
    const FragmentSurfaces surfaces(solid, labels, options.uneroded, intact, progress);
    return {measuredFragments(surfaces, solid, labels, options.uneroded, progress)};
  }
  Extraction extraction(solid, labels, options, progress);
  std::vector<Fragment> all;
  for (std::vector<Fragment> some = extraction.next(); !some.empty(); some = extraction.next()) {
    std::move(some.begin(), some.end(), std::back_inserter(all));
  }
  std::vector<std::vector<Contact>> contacts = extraction.contacts();
  for (std::size_t i = 0; i < all.size(); ++i) all[i].contacts = std::move(contacts[i]);
  return {std::move(all), extraction.exactFailure()};
}

std::vector<Fragment> extractFragments(const Solid& solid, const Labels& labels,
                                       const ExtractOptions& options, const Progress* progress) {
  return extractAll(solid, labels, options, progress).fragments;
}

TriangleMesh solidMesh(const Solid& solid, double adaptivity) {
  const IntactLabels intact(solid.blocks);
  const std::vector<LeafNeighbors> neighborhoods = leafNeighbors(solid.blocks->origins);
  const Creases creases(solid, neighborhoods, nullptr);
  const InterfaceMeshes meshes(solid, intact.labels, intact.cut, neighborhoods, creases);
  LabeledMesh mesh = meshes.meshOf(1);
  mesh.mesh.neighbor = mesh.other;
  if (solid.seams) cutTogether(std::span(&mesh, 1), *solid.seams, solid.frame);
  const Simplification simplification = simplificationOf({.adaptivity = adaptivity}, solid);
  if (!simplification.isAny()) return std::move(mesh.mesh);
  return std::move(simplified(complexOf(std::span(&mesh, 1)), simplification).front().mesh);
}

}  // namespace sherd
