// A whole fracture in figures.
#include <sherd/error.h>
#include <sherd/evaluate.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "mesh/turned_over.h"

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

void measureConvexity(FragmentFigures& figures, const TriangleMesh& body,
                      const EvaluateOptions& options, const Progress* progress) {
  if (!figures.quality->closed) {
    figures.noConvexity = "the mesh is open; a closed one is needed";
    return;
  }
  try {
    figures.convexity = convexity(body, options.samples, options.seed, progress);
  } catch (const Error& e) {
    if (e.code() != ErrorCode::input) throw;
    figures.noConvexity = e.what();
  }
}

/// What one fragment's own mesh tells; and the body that the fit is measured on.
FragmentFigures measure(const EvaluatedFragment& fragment, bool manifest,
                        const EvaluateOptions& options, const Progress* progress,
                        FragmentMesh& body) {
  FragmentFigures figures;
  figures.id = fragment.mesh.id;
  figures.name = fragment.name;
  figures.share = fragment.share;
  figures.volume = fragment.volume;
  figures.area = fragment.area;
  figures.fractureArea = fragment.fractureArea;
  figures.contacts = fragment.contacts;
  if (!hasMesh(fragment)) return figures;
  MeshQuality quality = meshQuality(fragment.mesh.mesh);
  quality.degenerateTriangles += fragment.droppedTriangles;
  figures.quality = quality;
  const bool inwards = quality.closed && quality.volume < 0.0;
  body = {fragment.mesh.id, inwards ? turnedOver(fragment.mesh.mesh) : fragment.mesh.mesh,
          fragment.mesh.facing};
  if (!manifest) {
    figures.volume = std::abs(quality.volume);
    figures.area = area(body.mesh);
  }
  measureConvexity(figures, body.mesh, options, progress);
  return figures;
}

void setMeanConvexity(Evaluation& evaluation) {
  std::vector<double> values;
  for (const FragmentFigures& f : evaluation.fragments) {
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

/// The fit of the meshes there are, put with their fragments.
void addFit(Evaluation& evaluation, std::span<const FragmentMesh> bodies, const TriangleMesh* whole,
            const EvaluateOptions& options, bool manifest, const Progress* progress) {
  std::vector<FragmentMesh> present;
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (!(area(bodies[i].mesh) > 0.0)) continue;
    present.push_back(bodies[i]);
    places.push_back(i);
  }
  const FitOptions fitOptions{options.samples, options.seed, options.tolerance};
  if (whole && openEdges(*whole) == 0 && volume(*whole) < 0.0) {
    const TriangleMesh outwards = turnedOver(*whole);
    evaluation.fit = fit(present, &outwards, fitOptions, progress);
  } else {
    evaluation.fit = fit(present, whole, fitOptions, progress);
  }
  for (std::size_t k = 0; k < places.size(); ++k) {
    FragmentFigures& figures = evaluation.fragments[places[k]];
    figures.fit = evaluation.fit.fragments[k];
    if (manifest) continue;
    figures.contacts = figures.fit.neighbours.size();
    figures.fractureArea = figures.fit.fractureShare * figures.area;
  }
}

/// Pairs that touch.  Of points that were drawn, one side may have found the other alone.
std::size_t touchingPairs(const Evaluation& evaluation, bool manifest) {
  if (manifest) {
    std::size_t ends = 0;
    for (const FragmentFigures& f : evaluation.fragments) ends += f.contacts;
    return ends / 2;  // each is told of by both its fragments
  }
  std::vector<std::pair<int, int>> pairs;
  for (const FragmentFigures& f : evaluation.fragments) {
    for (const int other : f.fit.neighbours) pairs.emplace_back(std::minmax(f.id, other));
  }
  std::sort(pairs.begin(), pairs.end());
  return static_cast<std::size_t>(std::unique(pairs.begin(), pairs.end()) - pairs.begin());
}

void sumUp(Evaluation& evaluation, bool manifest) {
  for (const FragmentFigures& f : evaluation.fragments) evaluation.volume += f.volume;
  std::vector<double> shares;
  for (FragmentFigures& f : evaluation.fragments) {
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
  evaluation.contacts = touchingPairs(evaluation, manifest);
  setMeanConvexity(evaluation);
}

void addNotes(Evaluation& evaluation, const FragmentSet& set, const TriangleMesh* whole) {
  std::vector<std::string>& notes = evaluation.notes;
  if (evaluation.open > 0) {
    notes.push_back(fragmentsAre(evaluation.open) +
                    " open: volume and share are not reliable, convexity and overlap not told");
  }
  std::size_t inwards = 0, flat = 0;
  for (const FragmentFigures& f : evaluation.fragments) {
    if (!f.quality || !f.quality->closed) continue;
    inwards += f.quality->volume < 0.0;
    flat += !f.convexity;
  }
  if (inwards > 0) notes.push_back(fragmentsAre(inwards) + " oriented inwards, and turned over");
  if (flat > 0) notes.push_back(fragmentsAre(flat) + " closed, but without a convexity");
  if (!whole) return;
  if (openEdges(*whole) > 0) notes.push_back("the unbroken mesh is open: its volume is not told");
  const bool meshes = std::any_of(set.fragments.begin(), set.fragments.end(), hasMesh);
  if (meshes && !evaluation.fit.surfaceError) {
    notes.push_back("no point of a fragment lies on the unbroken mesh: is it in another place?");
  }
}

}  // namespace

Evaluation evaluate(const FragmentSet& set, const TriangleMesh* whole,
                    const EvaluateOptions& options, const Progress* progress) {
  Evaluation evaluation;
  evaluation.fragments.resize(set.fragments.size());
  std::vector<FragmentMesh> bodies(set.fragments.size());
  tbb::parallel_for(std::size_t{0}, bodies.size(), [&](std::size_t i) {
    evaluation.fragments[i] = measure(set.fragments[i], set.manifest, options, progress, bodies[i]);
  });
  addFit(evaluation, bodies, whole, options, set.manifest, progress);
  sumUp(evaluation, set.manifest);
  addNotes(evaluation, set, whole);
  return evaluation;
}

}  // namespace sherd
