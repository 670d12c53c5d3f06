// Metrics of a whole fracture and of each fragment.
#include <sherd/error.h>
#include <sherd/evaluate.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "mesh/flipped_orientation.h"

namespace sherd {
namespace {

bool hasMesh(const EvaluatedFragment& fragment) { return !fragment.mesh.mesh.triangles.empty(); }

/// A sentence's subject: "1 fragment is", "3 fragments are".
std::string fragmentsAre(std::size_t count) {
  return std::to_string(count) + (count == 1 ? " fragment is" : " fragments are");
}

bool isSound(const MeshQuality& q) {
  return q.closed && q.manifold() && q.outward() &&
         q.degenerateTriangles + q.duplicateTriangles == 0;
}

void measureConvexity(FragmentMetrics& metrics, const TriangleMesh& oriented,
                      const EvaluateOptions& options, const Progress* progress) {
  if (!metrics.quality->closed) {
    metrics.noConvexity = "the mesh is open or inconsistently oriented; a closed one is needed";
    return;
  }
  try {
    metrics.convexity = convexity(oriented, options.samples, options.seed, progress);
  } catch (const Error& e) {
    if (e.code() != ErrorCode::input) throw;
    metrics.noConvexity = e.what();
  }
}

/// Measures one fragment from its own mesh, and returns in `oriented` the mesh for the fit.
FragmentMetrics measure(const EvaluatedFragment& fragment, bool manifest,
                        const EvaluateOptions& options, const Progress* progress,
                        FragmentMesh& oriented) {
  FragmentMetrics metrics;
  metrics.id = fragment.mesh.id;
  metrics.name = fragment.name;
  metrics.share = fragment.share;
  metrics.volume = fragment.volume;
  metrics.area = fragment.area;
  metrics.fractureArea = fragment.fractureArea;
  metrics.contacts = fragment.contacts;
  if (!hasMesh(fragment)) return metrics;
  MeshQuality quality = meshQuality(fragment.mesh.mesh);
  quality.degenerateTriangles += fragment.droppedTriangles;
  metrics.quality = quality;
  const bool inwards = quality.closed && quality.volume < 0.0;
  oriented = {fragment.mesh.id,
              inwards ? flippedOrientation(fragment.mesh.mesh) : fragment.mesh.mesh};
  if (!manifest) {
    metrics.volume = std::abs(quality.volume);
    metrics.area = area(oriented.mesh);
  }
  measureConvexity(metrics, oriented.mesh, options, progress);
  return metrics;
}

void setMeanConvexity(Evaluation& evaluation) {
  std::vector<double> values;
  for (const FragmentMetrics& f : evaluation.fragments) {
    if (f.convexity) values.push_back(f.convexity->value);
  }
  if (values.empty()) return;
  const double count = static_cast<double>(values.size());
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / count;
  evaluation.convexity = mean;
  if (values.size() < 2) return;
  double squares = 0.0;
  for (const double value : values) squares += (value - mean) * (value - mean);
  evaluation.convexityStandardError = std::sqrt(squares / (count - 1.0) / count);
}

void addQuality(MeshQuality& sum, const MeshQuality& q) {
  const auto n = static_cast<double>(sum.triangles), m = static_cast<double>(q.triangles);
  const auto mean = [&](double a, double b) { return (n * a + m * b) / (n + m); };
  sum.smallestAngle =
      sum.triangles == 0 ? q.smallestAngle : std::min(sum.smallestAngle, q.smallestAngle);
  sum.meanSmallestAngle = mean(sum.meanSmallestAngle, q.meanSmallestAngle);
  sum.sliverShare = mean(sum.sliverShare, q.sliverShare);
  sum.closed = (sum.triangles == 0 || sum.closed) && q.closed;
  sum.vertices += q.vertices;
  sum.triangles += q.triangles;
  sum.components += q.components;
  sum.boundaryEdges += q.boundaryEdges;
  sum.nonManifoldEdges += q.nonManifoldEdges;
  sum.flippedEdges += q.flippedEdges;
  sum.nonManifoldVertices += q.nonManifoldVertices;
  sum.degenerateTriangles += q.degenerateTriangles;
  sum.duplicateTriangles += q.duplicateTriangles;
  for (std::size_t i = 0; i < sum.smallestAngles.size(); ++i) {
    sum.smallestAngles[i] += q.smallestAngles[i];
  }
  sum.volume += q.volume;
}

/// Measures the fit of the meshes with area, and stores it with their fragments.
void addFit(Evaluation& evaluation, std::span<const FragmentMesh> meshes, const TriangleMesh* whole,
            const EvaluateOptions& options, bool manifest, const Progress* progress) {
  std::vector<FragmentMesh> present;
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    if (!(area(meshes[i].mesh) > 0.0)) continue;
    present.push_back(meshes[i]);
    indices.push_back(i);
  }
  const FitOptions fitOptions{options.samples, options.seed, options.tolerance};
  if (whole && openEdges(*whole) == 0 && volume(*whole) < 0.0) {
    const TriangleMesh outwards = flippedOrientation(*whole);
    evaluation.fit = fit(present, &outwards, fitOptions, progress);
  } else {
    evaluation.fit = fit(present, whole, fitOptions, progress);
  }
  for (std::size_t k = 0; k < indices.size(); ++k) {
    FragmentMetrics& metrics = evaluation.fragments[indices[k]];
    metrics.fit = evaluation.fit.fragments[k];
    if (manifest) continue;
    metrics.contacts = metrics.fit.neighbors.size();
    metrics.fractureArea = metrics.fit.fractureShare * metrics.area;
  }
}

/// Counts pairs in contact.  By sampled points, only one fragment of a pair may have found it.
std::size_t contactPairs(const Evaluation& evaluation, bool manifest) {
  if (manifest) {
    std::size_t ends = 0;
    for (const FragmentMetrics& f : evaluation.fragments) ends += f.contacts;
    return ends / 2;  // both fragments of a pair count it
  }
  std::vector<std::pair<int, int>> pairs;
  for (const FragmentMetrics& f : evaluation.fragments) {
    for (const int other : f.fit.neighbors) pairs.emplace_back(std::minmax(f.id, other));
  }
  std::sort(pairs.begin(), pairs.end());
  return static_cast<std::size_t>(std::unique(pairs.begin(), pairs.end()) - pairs.begin());
}

void sumUp(Evaluation& evaluation, bool manifest) {
  for (const FragmentMetrics& f : evaluation.fragments) evaluation.volume += f.volume;
  std::vector<double> shares;
  for (FragmentMetrics& f : evaluation.fragments) {
    if (!manifest) f.share = evaluation.volume > 0.0 ? f.volume / evaluation.volume : 0.0;
    shares.push_back(f.share);
    evaluation.area += f.area;
    evaluation.fractureArea += f.fractureArea;
    if (!f.quality) continue;
    addQuality(evaluation.quality, *f.quality);
    evaluation.sound += isSound(*f.quality);
    evaluation.open += !f.quality->closed;
  }
  const auto [smallest, largest] = std::minmax_element(shares.begin(), shares.end());
  evaluation.smallestShare = *smallest;
  evaluation.largestShare = *largest;
  evaluation.effectiveFragments = effectiveCount(shares);
  evaluation.contacts = contactPairs(evaluation, manifest);
  setMeanConvexity(evaluation);
}

void addNotes(Evaluation& evaluation, const FragmentSet& set, const TriangleMesh* whole) {
  std::vector<std::string>& notes = evaluation.notes;
  if (evaluation.open > 0) {
    notes.push_back(
        fragmentsAre(evaluation.open) +
        " open or inconsistently oriented: volume and share are unreliable, convexity and overlap "
        "are not measured");
  }
  std::size_t inwards = 0, flat = 0;
  for (const FragmentMetrics& f : evaluation.fragments) {
    if (!f.quality || !f.quality->closed) continue;
    inwards += f.quality->volume < 0.0;
    flat += !f.convexity;
  }
  if (inwards > 0)
    notes.push_back(fragmentsAre(inwards) +
                    " oriented inwards; convexity and fit use the flipped mesh");
  if (flat > 0) notes.push_back(fragmentsAre(flat) + " closed but without a convexity");
  if (!whole) return;
  if (openEdges(*whole) > 0)
    notes.push_back(
        "the intact mesh is open or inconsistently oriented: its volume is not measured");
  const bool hasMeshes = std::any_of(set.fragments.begin(), set.fragments.end(), hasMesh);
  if (hasMeshes && !evaluation.fit.surfaceError) {
    notes.push_back(
        "no sampled point lies on the intact mesh; fragments and mesh need the same coordinates");
  }
}

}  // namespace

Evaluation evaluate(const FragmentSet& set, const TriangleMesh* whole,
                    const EvaluateOptions& options, const Progress* progress) {
  Evaluation evaluation;
  evaluation.fragments.resize(set.fragments.size());
  std::vector<FragmentMesh> meshes(set.fragments.size());
  tbb::parallel_for(std::size_t{0}, meshes.size(), [&](std::size_t i) {
    evaluation.fragments[i] = measure(set.fragments[i], set.manifest, options, progress, meshes[i]);
  });
  addFit(evaluation, meshes, whole, options, set.manifest, progress);
  sumUp(evaluation, set.manifest);
  addNotes(evaluation, set, whole);
  return evaluation;
}

}  // namespace sherd
