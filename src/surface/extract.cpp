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
#include "cut/intact_labels.h"
#include "cut/level_set.h"
#include "grow/fields/check_labels.h"
#include "grow/fields/label_slices.h"
#include "intersect/self_crossings.h"
#include "remesh/decimate/decimate.h"
#include "remesh/parts/small_voids.h"
#include "remesh/resample/crack_jitter.h"
#include "remesh/resample/resample.h"
#include "remesh/seam_charts.h"
#include "remesh/seam_cuts.h"
#include "remesh/smooth.h"
#include "surface/check_finite.h"
#include "surface/exact/exact_meshes.h"
#include "surface/label_mesh.h"
#include "voxelize/leaves/leaf_blocks.h"

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
  for (std::size_t leaf = 0; leaf < blocks.count(); ++leaf) {
    const openvdb::Coord& origin = blocks.origins[leaf];
    forEachLabelSlice(labels, leaf, [&](std::uint16_t label, std::size_t x, std::uint64_t bits) {
      if (label >= end) return;
      std::uint64_t row = bits;  // bits z of all y
      for (const int shift : {32, 16, 8}) row |= row >> shift;
      row &= 0xff;
      const auto at = [&](int y, int z) {
        return origin + openvdb::Coord(static_cast<int>(x), y, z);
      };
      boxes[label].min.minComponent(at(std::countr_zero(bits) / 8, std::countr_zero(row)));
      boxes[label].max.maxComponent(
          at((63 - std::countl_zero(bits)) / 8, 63 - std::countl_zero(row)));
    });
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

std::size_t crossingsOf(const TriangleMesh& mesh) {
  return selfCrossings(mesh.vertices, mesh.triangles).size();
}

// [triangles] true on the solid's surface.
std::vector<bool> onSolid(const LabeledMesh& mesh) {
  std::vector<bool> original;
  for (const std::uint16_t other : mesh.other) original.push_back(other == 0);
  return original;
}

// Exact surfaces have a cut of their own, labels need none.
CutExtent extentFor(const SurfaceOptions& surface) {
  if (surface.levelSets) return CutExtent::everywhere;
  return surface.surface == Surface::smooth ? CutExtent::cells : CutExtent::none;
}

SurfaceOptions decidedSurface(const Solid& solid, const ExtractOptions& options,
                              const Progress* progress) {
  checkSurfaceOptions(options.surface);
  if (options.uneroded != nullptr) checkLabels(*options.uneroded, solid);
  reportProgress(progress, "extract", 0.0);
  SurfaceOptions surface = options.surface;
  const bool hasMesh = solid.mesh != nullptr || options.exact != nullptr;
  if (surface.surface == Surface::automatic && !hasMesh) surface.surface = Surface::smooth;
  surface.surface = surfaceOf(surface);
  return surface;
}

}  // namespace

Extraction::Extraction(const Solid& solid, const Labels& labels, const ExtractOptions& options,
                       const Progress* progress)
    : solid_(solid),
      labels_(labels),
      uneroded_(options.uneroded),
      surface_(decidedSurface(solid, options, progress)),
      keepsUnmerged_(options.surface.points && samplesLabelSurfaces(options.surface)),
      progress_(progress),
      intact_(options.intact),
      seed_(options.seed),
      noise_(surface_, solid, options.seed),
      count_(static_cast<std::size_t>(labels.fragmentCount)),
      voxels_(checkedCounts(labels, solid)),
      boxes_(voxelBoxes(*solid.blocks, labels)),
      cut_(
          std::make_shared<CutSolid>(solid, labels, options.intact, extentFor(surface_), progress)),
      leaves_(leavesOf(cut_->cut(), count_)) {
  if (surface_.surface == Surface::exact) {
    makeExact(options.exact ? std::move(*options.exact)
                            : exactMeshes(solid_, labels_, uneroded_, cut_->neighborhoods(),
                                          crackAdaptivity(surface_), progress_));
    if (surface_.surface == Surface::smooth) cutAnew();
  }
  meshedAs_.resize(count_, surface_.surface);
  if (surface_.surface == Surface::smooth) makeSmooth();
}

// Cuts the solid as the smooth surface needs it, which replaces exact ones.
void Extraction::cutAnew() {
  cut_ = std::make_shared<CutSolid>(solid_, labels_, intact_, extentFor(surface_), progress_);
  leaves_ = leavesOf(cut_->cut(), count_);
}

void Extraction::makeSmooth() {
  cut_->findCreases(solid_, progress_);
  simplification_ = simplificationOf(surface_, solid_, intact_.get());
  auto made = std::make_shared<FragmentSurfaces>(solid_, labels_, uneroded_, cut_,
                                                 SurfaceVertices::all, progress_);
  if (keepsUnmerged_) made->displacePoints(noise_, progress_);
  std::shared_ptr<const FragmentSurfaces> shared = std::move(made);
  if (!isShared()) {
    if (keepsUnmerged_) unmerged_ = shared;
    resampled_ = std::move(shared);
    return;
  }
  const bool isProcessed = simplification_.changesMeshes() || !surface_.triangles.empty() ||
                           movesAnything(surface_.smooth, solid_.box.longestSide()) ||
                           noise_.isAny() || !smooth_.empty();
  if (isProcessed) {
    processTogether(std::move(shared));
  } else {
    surfaces_ = std::move(shared);
  }
}

void Extraction::makeExact(ExactSurface exact) {
  if (!exact.failure.empty()) {
    exactFailure_ = std::move(exact.failure);
    surface_.surface = Surface::smooth;
    return;
  }
  united_ = std::move(exact.united);
  smooth_ = std::move(exact.smooth);
  meshedAs_.assign(count_, Surface::exact);
  for (const SmoothBodies& bodies : smooth_) {
    surface_.surface = Surface::smooth;
    for (const int id : bodies.fragments) {
      meshedAs_[static_cast<std::size_t>(id) - 1] = Surface::smooth;
    }
  }
  for (std::size_t i = 0; i < count_; ++i) {
    LabeledMesh& mesh = exact.meshes[i];
    if (!mesh.mesh.neighbor.empty()) continue;  // set where voxels are those of other bodies
    mesh.mesh.neighbor = mesh.other;
    if (!uneroded_ || isSmooth(i)) continue;
    mesh.mesh.neighbor = neighborsOf(mesh.mesh, onSolid(mesh), static_cast<std::uint16_t>(i + 1),
                                     solid_, *uneroded_, true);
    partKinds(mesh, i);
  }
  if (!surface_.triangles.empty()) {
    processed_.coarse = decimated(complexOf(exact.meshes), surface_.triangles, progress_);
  }
  processed_.meshes = std::move(exact.meshes);
}

// Makes faces between an exact fragment and a smooth one those of the original surface: they are of
// bodies that are nearer to each other than a voxel, and have no crack in common.
void Extraction::partKinds(LabeledMesh& mesh, std::size_t i) const {
  if (smooth_.empty()) return;
  for (std::size_t t = 0; t < mesh.other.size(); ++t) {
    const auto isOther = [&](std::uint16_t label) {
      return label != 0 && label <= count_ && meshedAs_[label - 1u] != meshedAs_[i];
    };
    if (!isOther(mesh.other[t]) && !isOther(mesh.mesh.neighbor[t])) continue;
    if (isOther(mesh.other[t])) mesh.other[t] = 0;
    mesh.mesh.neighbor[t] = 0;
  }
}

LabeledMesh Extraction::smoothMesh(const FragmentSurfaces& surfaces, std::size_t i) const {
  if (!isSmooth(i)) return {};
  LabeledMesh mesh = surfaces.meshOf(static_cast<std::uint16_t>(i + 1));
  partKinds(mesh, i);
  return mesh;
}

// Frees what is not needed any more before the next step, which takes about as much memory: the
// surfaces too, unless points are sampled of them.
void Extraction::processTogether(std::shared_ptr<const FragmentSurfaces> surfaces) {
  Processed all;
  all.meshes.resize(count_);
  CancelFlag stop(progress_);
  tbb::parallel_for(std::size_t{0}, count_, [&](std::size_t i) {
    if (!stop.isSet()) all.meshes[i] = smoothMesh(*surfaces, i);
  });
  stop.throwIfSet();
  if (keepsUnmerged_) unmerged_ = surfaces;
  surfaces.reset();
  smoothTogether(all.meshes, surface_.smooth, solid_.box.longestSide(), progress_);
  throwIfCancelled(progress_);
  if (solid_.seams) all.cutFaces = cutTogether(all.meshes, *solid_.seams, solid_.frame);
  if (simplification_.changesMeshes()) {
    all.cutFaces.clear();
    LabeledComplex complex = complexOf(std::exchange(all.meshes, {}));
    all.meshes = simplified(std::move(complex), simplification_, progress_);
  }
  if (!surface_.triangles.empty()) {
    all.coarse = decimated(complexOf(all.meshes), surface_.triangles, progress_);
  }
  for (std::size_t i = 0; i < processed_.meshes.size(); ++i) {  // of exact fragments
    if (isSmooth(i)) continue;
    all.meshes[i] = std::move(processed_.meshes[i]);
    if (!all.coarse.empty()) all.coarse[i] = std::move(processed_.coarse[i]);
  }
  processed_ = std::move(all);
}

void Extraction::meshShared(Fragment& fragment) {
  const std::size_t i = static_cast<std::size_t>(fragment.id) - 1;
  if (surfaces_) {
    fragment.mesh = std::move(surfaces_->meshOf(static_cast<std::uint16_t>(fragment.id)).mesh);
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
    fragment.mesh =
        smoothed(meshOfFaces(facesOf(solid_, labels_, before, id, leaves), solid_.frame),
                 surface_.smooth, solid_.box.longestSide(), progress_);
  } else {
    LabeledMesh meshed =
        withoutSmallVoids(smoothMesh(*resampled_, id - std::size_t{1}), solid_.frame.voxelSize);
    meshed.mesh =
        smoothed(std::move(meshed.mesh), surface_.smooth, solid_.box.longestSide(), progress_);
    fragment.mesh = resampled(meshed, solid_.frame, key);
    // Planes are merged first: they would no longer be planes.
    if (!simplification_.changesMeshes()) jitterCracks(fragment.mesh, solid_.frame, key);
  }
  if (surface_.surface == Surface::smooth) cutSeams(fragment);
  std::vector<std::uint32_t> charts;
  const bool isSimplified = simplification_.changesMeshes() || !surface_.triangles.empty();
  if (isSimplified && solid_.seams && surface_.surface == Surface::smooth)
    charts = seamCharts(fragment.mesh, *solid_.seams, solid_.frame);
  if (simplification_.changesMeshes()) {
    fragment.cutFaces.clear();
    LabeledMesh simple =
        std::move(simplified(complexOf(fragment.mesh, charts), simplification_, progress_).front());
    jitterCracks(simple.mesh, solid_.frame, key);
    const std::size_t crossings = crossingsOf(simple.mesh);
    if (crossings > 0) jitterCracks(fragment.mesh, solid_.frame, key);
    if (crossings == 0 || crossings <= crossingsOf(fragment.mesh)) {
      fragment.mesh = std::move(simple.mesh);
      charts = std::move(simple.chart);
    }
  }
  fragment.coarse =
      std::move(decimated(complexOf(fragment.mesh, charts), surface_.triangles, progress_).front());
}

Fragment Extraction::makeFragment(std::size_t i) {
  const auto id = static_cast<std::uint16_t>(i + 1);
  Fragment fragment = surfaces_ ? surfaces_->measured(id) : Fragment{};
  fragment.id = id;
  fragment.voxels = voxels_[i + 1];
  fragment.voxelBox = boxes_[i + 1];
  if (surface_.levelSets) fragment.surface = fragmentLevelSet(solid_, cut_->cut(), id, leaves_[id]);
  fragment.meshedAs = meshedAs_[i];
  const bool isMade = fragment.meshedAs == Surface::exact || (isSmooth(i) && isShared());
  isMade ? meshShared(fragment) : meshIndependent(fragment);
  if (!surfaces_) {
    fragment.mass = massProperties(fragment.mesh);
    measureAreas(fragment);
  }
  checkFinite(fragment);
  return fragment;
}

// Displaces surfaces whose contacts are measured.
void Extraction::addNoise(std::span<Fragment> fragments) const {
  CancelFlag stop(progress_);
  tbb::parallel_for(std::size_t{0}, fragments.size(), [&](std::size_t i) {
    if (stop.isSet()) return;
    Fragment& fragment = fragments[i];
    const auto id = static_cast<std::uint16_t>(fragment.id);
    noise_.move(fragment.mesh, id);
    for (TriangleMesh& mesh : fragment.coarse) noise_.move(mesh, id);
    fragment.mass = massProperties(fragment.mesh);
    measureAreas(fragment);
    checkFinite(fragment);
  });
  stop.throwIfSet();
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
  if (!surfaces_) {
    for (const Fragment& fragment : fragments) measure_.add(fragment);
  }
  if (noise_.isAny()) addNoise(fragments);
  reportProgress(progress_, "extract", static_cast<double>(next_) / static_cast<double>(count_));
  return fragments;
}

ContactSums Extraction::voxelContactsOf() const {
  const Labels& before = uneroded_ ? *uneroded_ : labels_;
  return voxelContacts(solid_, before, cut_->cut(), cut_->neighborhoods());
}

std::vector<std::vector<Contact>> Extraction::contacts() const {
  std::vector<std::vector<Contact>> all =
      surfaces_ ? surfaces_->contacts(solid_, uneroded_ ? *uneroded_ : labels_)
                : measure_.contacts(count_, voxelContactsOf());
  checkFinite(all);
  return all;
}

std::vector<Fragment> measuredFragments(const FragmentSurfaces& surfaces, const Solid& solid,
                                        const Labels& labels, const Labels* uneroded,
                                        const Progress* progress) {
  const std::vector<std::uint64_t> voxels = checkedCounts(labels, solid);
  const std::vector<VoxelBox> boxes = voxelBoxes(*solid.blocks, labels);
  std::vector<std::vector<Contact>> contacts =
      surfaces.contacts(solid, uneroded ? *uneroded : labels);
  checkFinite(contacts);
  std::vector<Fragment> all(surfaces.count());
  CancelFlag stop(progress);
  tbb::parallel_for(std::size_t{0}, all.size(), [&](std::size_t i) {
    if (stop.isSet()) return;
    all[i] = surfaces.measured(static_cast<std::uint16_t>(i + 1));
    all[i].voxels = voxels[i + 1];
    all[i].voxelBox = boxes[i + 1];
    all[i].contacts = std::move(contacts[i]);
    all[i].id = static_cast<int>(i + 1);
    checkFinite(all[i]);
  });
  stop.throwIfSet();
  return all;
}

ExtractedFragments extractAll(const Solid& solid, const Labels& labels,
                              const ExtractOptions& options, const Progress* progress) {
  if (!options.surface.meshes) {
    (void)decidedSurface(solid, options, progress);
    auto surfaces = std::make_shared<const FragmentSurfaces>(solid, labels, options.uneroded,
                                                             options.intact, progress);
    return {.fragments = measuredFragments(*surfaces, solid, labels, options.uneroded, progress),
            .surfaces = surfaces};
  }
  Extraction extraction(solid, labels, options, progress);
  std::vector<Fragment> all;
  for (std::vector<Fragment> some = extraction.next(); !some.empty(); some = extraction.next()) {
    std::move(some.begin(), some.end(), std::back_inserter(all));
  }
  std::vector<std::vector<Contact>> contacts = extraction.contacts();
  for (std::size_t i = 0; i < all.size(); ++i) all[i].contacts = std::move(contacts[i]);
  return {.fragments = std::move(all),
          .exactFailure = extraction.exactFailure(),
          .smooth = extraction.smooth(),
          .surfaces = extraction.surfaces(),
          .unmerged = extraction.unmerged(),
          .united = extraction.united()};
}

std::vector<Fragment> extractFragments(const Solid& solid, const Labels& labels,
                                       const ExtractOptions& options, const Progress* progress) {
  return extractAll(solid, labels, options, progress).fragments;
}

TriangleMesh solidMesh(const Solid& solid, double adaptivity) {
  const IntactLabels intact(solid.blocks);
  const std::vector<LeafNeighbors> neighborhoods = leafNeighbors(solid.blocks->origins);
  const Creases creases(solid, neighborhoods, nullptr);
  const InterfaceSurface surface(solid, intact.labels, intact.cut, neighborhoods, creases, nullptr,
                                 SurfaceVertices::all, nullptr);
  LabeledMesh mesh = InterfaceMeshes(surface, neighborhoods, nullptr).meshOf(1);
  mesh.mesh.neighbor = mesh.other;
  if (solid.seams) cutTogether(std::span(&mesh, 1), *solid.seams, solid.frame);
  const Simplification simplification =
      simplificationOf({.surface = Surface::smooth, .adaptivity = adaptivity}, solid);
  if (!simplification.changesMeshes()) return std::move(mesh.mesh);
  return std::move(simplified(complexOf(std::span(&mesh, 1)), simplification).front().mesh);
}

}  // namespace sherd
