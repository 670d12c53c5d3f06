// The bodies of an input mesh that fragments with exact surfaces come from.
#include "folder/manifest/input_bodies.h"

#include <algorithm>

#include "folder/manifest/rounding.h"
#include "remesh/bodies.h"
#include "remesh/parts/close_mesh.h"

namespace sherd {

std::vector<std::uint32_t> InputBodies::of(const TriangleMesh& mesh) const {
  if (count == 0) return {};
  std::vector<bool> has(count, false);
  for (const std::uint32_t triangle : mesh.source) {
    if (triangle != TriangleMesh::kNoSource && ofTriangle[triangle] != kNone) {
      has[ofTriangle[triangle]] = true;
    }
  }
  std::vector<std::uint32_t> bodies;
  for (std::uint32_t body = 0; body < count; ++body) {
    if (has[body]) bodies.push_back(body);
  }
  return bodies;
}

std::vector<std::vector<std::string>> InputBodies::objects(const SourceMesh& source) const {
  if (count == 0 || source.objects.size() < 2 || source.objectOfTriangle.empty()) return {};
  std::vector<std::vector<std::uint32_t>> numbers(count);
  for (std::size_t t = 0; t < ofTriangle.size(); ++t) {
    if (ofTriangle[t] == kNone) continue;
    std::vector<std::uint32_t>& own = numbers[ofTriangle[t]];
    const std::uint32_t object = source.objectOfTriangle[t];
    const auto at = std::lower_bound(own.begin(), own.end(), object);
    if (at == own.end() || *at != object) own.insert(at, object);
  }
  std::vector<std::vector<std::string>> names(count);
  for (std::size_t body = 0; body < count; ++body) {
    for (const std::uint32_t object : numbers[body]) names[body].push_back(source.objects[object]);
  }
  return names;
}

namespace {

// Returns bodies that are kept: none of them are united.
InputBodies keptBodies(const SolidMesh& mesh) {
  InputBodies found;
  for (const std::uint32_t body : mesh.body) {
    found.count = std::max(found.count, std::size_t{body} + 1);
  }
  found.united = found.count;
  const std::uint32_t last = *std::ranges::max_element(mesh.source);
  found.ofTriangle.assign(last + std::size_t{1}, InputBodies::kNone);
  for (std::size_t t = 0; t < mesh.body.size(); ++t) {
    found.ofTriangle[mesh.source[t]] = mesh.body[t];
  }
  return found;
}

}  // namespace

InputBodies inputBodies(const FractureResult& result, const FractureOptions& options) {
  const Solid& solid = result.solid;
  if (!isExact(options, result) || solid.mesh == nullptr || isShell(solid)) return {};
  // Bodies that touch in vertices alone may be one component, but are united.
  if (result.united.mesh == nullptr && solid.report.defects.components < 2) return {};
  if (!solid.mesh->body.empty()) return keptBodies(*solid.mesh);
  std::vector<TriangleMesh> bodies = bodiesOf(solid.mesh->mesh);
  if (bodies.size() < 2) return {};
  const std::vector<std::uint32_t>& source = solid.mesh->source;
  // The first triangle of a body is its outer component's, which comes first.
  std::sort(bodies.begin(), bodies.end(), [](const TriangleMesh& a, const TriangleMesh& b) {
    return a.source.front() < b.source.front();
  });
  InputBodies found{.count = bodies.size(),
                    .united = result.united.mesh ? result.united.after : bodies.size()};
  const std::uint32_t last = source.empty() ? 0 : *std::ranges::max_element(source);
  found.ofTriangle.assign(last + std::size_t{1}, InputBodies::kNone);
  for (std::uint32_t body = 0; body < bodies.size(); ++body) {
    for (const std::uint32_t t : bodies[body].source) found.ofTriangle[source[t]] = body;
  }
  for (const SmoothBodies& smooth : result.smooth) {
    TriangleMesh own;
    own.source = smooth.triangles;
    for (const int id : smooth.fragments) found.ofSmooth[id] = found.of(own);
  }
  return found;
}

}  // namespace sherd
