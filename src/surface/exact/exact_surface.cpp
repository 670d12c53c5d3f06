// Labels the parts of the mesh and of the cracks.  Seams, where they cross, separate patches: all
// triangles of a patch have one label, which any seam on its border gives.
#include "surface/exact/exact_surface.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <utility>

#include "base/cancel_flag.h"
#include "intersect/crossing_point.h"
#include "intersect/cut_mesh.h"
#include "intersect/self_crossings.h"
#include "mesh/largest_axis.h"
#include "remesh/flat_triangles.h"
#include "remesh/manifold.h"
#include "remesh/vertex_numbers.h"
#include "surface/exact/patches.h"

namespace sherd {
namespace {

constexpr const char* kRounding = "rounding makes parts of the surface cross";

constexpr auto kNoIsland = std::numeric_limits<std::size_t>::max();

// A face of a fragment.
struct Face {
  glm::uvec3 corner{0};
  std::uint32_t source = 0;
  std::uint16_t neighbor = 0;  // label on the other side
  std::uint32_t part = 0;      // of the mesh or of the cracks
  std::uint8_t side = 0;       // of a crack: 0 its front's, 1 its back's
};

class FragmentAssembler {
 public:
  FragmentAssembler(const TriangleMesh& source, const LabeledComplex& cracks, std::size_t fragments,
                    const SpaceLabels& space)
      : source_(source), cracks_(cracks), fragments_(fragments), space_(space) {}

  ExactSurface assemble(const Progress* progress) {
    Cutters cutters{cracks_.vertices, {}};
    for (const ComplexFace& face : cracks_.faces) cutters.triangles.push_back(face.corner);
    const MeshCut cut = cutMesh(source_, cutters, progress);
    flat_ = cut.flat;
    if (!cut.isComplete())
      return {.failure = failureOf(cut), .isDegenerate = !cut.degenerate.empty()};
    throwIfCancelled(progress);
    vertices_ = source_.vertices;
    vertices_.insert(vertices_.end(), cutters.vertices.begin(), cutters.vertices.end());
    vertices_.insert(vertices_.end(), cut.points.begin(), cut.points.end());
    const auto firstCutter = static_cast<std::uint32_t>(source_.vertices.size());
    const Patches outside(partsOf(source_.triangles, cut.surfaceCrossed, cut.surface, 0),
                          vertices_.size(), cut.seams);
    const Patches inside(partsOf(cutters.triangles, cut.cutterCrossed, cut.cutters, firstCutter),
                         vertices_.size(), cut.seams);
    throwIfCancelled(progress);
    if (!labelOutside(outside, cut.seams))
      return {.failure = "a part of the surface lies on both sides of a crack",
              .isDegenerate = true};
    if (!findInside(inside, cut.seams))
      return {.failure = "a part of a crack lies on both sides of the surface",
              .isDegenerate = true};
    throwIfCancelled(progress);
    if (std::string failure = newCrossings(cut, inside, progress); !failure.empty()) {
      return {.failure = std::move(failure), .isDegenerate = true};
    }
    return assembled(outside, inside, progress);
  }

  // The triangles without area that cracks meet.
  const std::vector<std::uint32_t>& flat() const { return flat_; }

 private:
  static std::string failureOf(const MeshCut& cut) {
    if (!cut.surfaceCrossings.empty()) return "the surface crosses itself at a crack";
    if (!cut.cutterCrossings.empty()) return "cracks cross each other at the surface";
    if (!cut.flat.empty()) return "a crack meets a triangle without area";
    return "a crack meets the surface in a degenerate position";
  }

  glm::dvec3 centroidOf(const Part& part) const {
    return (vertices_[part.corner.x] + vertices_[part.corner.y] + vertices_[part.corner.z]) / 3.0;
  }

  // Sets [parts] the labels of the mesh.  Returns false if seams contradict each other.
  bool labelOutside(const Patches& outside, const std::vector<Seam>& seams) {
    std::vector<std::uint16_t> ofPatch(outside.parts().size(), 0);
    bool isConsistent = true;
    for (const Seam& seam : seams) {
      const ComplexFace& crack = cracks_.faces[seam.c];
      isConsistent &= outside.forEachBeside(seam, [&](std::uint32_t part, bool isLeft) {
        const std::uint16_t label = isLeft == Seam::leftInSurfaceIsFront ? crack.back : crack.front;
        std::uint16_t& known = ofPatch[outside.patchOf(part)];
        isConsistent &= known == 0 || known == label;
        known = label;
      });
    }
    if (!isConsistent) return false;
    labelAway(outside, ofPatch);
    label_.resize(outside.parts().size());
    for (std::uint32_t p = 0; p < label_.size(); ++p) label_[p] = ofPatch[outside.patchOf(p)];
    return true;
  }

  // Labels the patches that no crack meets, by most of their triangles.
  void labelAway(const Patches& outside, std::vector<std::uint16_t>& ofPatch) const {
    constexpr std::size_t kMostSamples = 64;
    std::vector<std::vector<std::uint32_t>> partsOfPatch(outside.parts().size());
    for (std::uint32_t p = 0; p < outside.parts().size(); ++p) {
      const std::uint32_t patch = outside.patchOf(p);
      if (ofPatch[patch] == 0) partsOfPatch[patch].push_back(p);
    }
    for (std::uint32_t patch = 0; patch < partsOfPatch.size(); ++patch) {
      const std::vector<std::uint32_t>& own = partsOfPatch[patch];
      if (own.empty()) continue;
      std::vector<std::uint16_t> found;
      const std::size_t step = own.size() / kMostSamples + 1;
      for (std::size_t i = 0; i < own.size(); i += step) {
        const std::uint16_t label = space_.labelAt(centroidOf(outside.parts()[own[i]]));
        if (label != 0) found.push_back(label);
      }
      ofPatch[patch] = found.empty() ? space_.nearestLabel(centroidOf(outside.parts()[own.front()]))
                                     : mostFrequent(std::move(found));
    }
  }

  static std::uint16_t mostFrequent(std::vector<std::uint16_t> labels) {
    std::sort(labels.begin(), labels.end());
    std::uint16_t best = 0;
    std::ptrdiff_t most = 0;
    for (auto at = labels.begin(); at != labels.end();) {
      const auto end = std::upper_bound(at, labels.end(), *at);
      if (end - at > most) {
        most = end - at;
        best = *at;
      }
      at = end;
    }
    return best;
  }

  // Sets [parts] whether a part of the cracks is within the mesh.  Returns false if seams
  // contradict each other, or a crack ends inside.
  bool findInside(const Patches& inside, const std::vector<Seam>& seams) {
    enum : std::uint8_t { unknown, in, out };
    std::vector<std::uint8_t> ofPatch(inside.parts().size(), unknown);
    bool isConsistent = true;
    for (const Seam& seam : seams) {
      isConsistent &= inside.forEachBeside(seam, [&](std::uint32_t part, bool isLeft) {
        const std::uint8_t side = isLeft == Seam::leftInCutterIsFront ? out : in;
        std::uint8_t& known = ofPatch[inside.patchOf(part)];
        isConsistent &= known == unknown || known == side;
        known = side;
      });
    }
    for (std::size_t e = 0; e < inside.edges().count(); ++e) {
      const auto uses = inside.edges().uses(e);
      if (uses.size() != 1 || inside.isSeam(e)) continue;
      std::uint8_t& known = ofPatch[inside.patchOf(uses[0].face)];
      isConsistent &= known != in;
      known = out;
    }
    if (!isConsistent) return false;
    isInside_.resize(inside.parts().size());
    for (std::uint32_t p = 0; p < isInside_.size(); ++p) {
      std::uint8_t& known = ofPatch[inside.patchOf(p)];
      if (known == unknown) known = space_.isInside(centroidOf(inside.parts()[p])) ? in : out;
      isInside_[p] = known == in;
    }
    return true;
  }

  // Whether parts of cut triangles are flipped or cross each other, as their new corners are
  // rounded.
  //   return  a failure, or nothing
  std::string newCrossings(const MeshCut& cut, const Patches& inside,
                           const Progress* progress) const {
    std::vector<glm::uvec3> parts;
    std::vector<std::uint32_t> sources;
    std::vector<std::uint8_t> isPart;  // of a crossed triangle
    const auto add = [&](const glm::uvec3& corner, std::size_t source, std::uint8_t isCrossed) {
      parts.push_back(corner);
      sources.push_back(static_cast<std::uint32_t>(source));
      isPart.push_back(isCrossed);
    };
    for (const CutTriangle& part : cut.surface) add(part.corner, part.source, 1);
    const std::size_t ofSurface = parts.size();
    for (std::size_t p = 0; p < inside.parts().size(); ++p) {
      const Part& part = inside.parts()[p];
      if (isInside_[p]) {
        add(part.corner, source_.triangles.size() + part.source, cut.cutterCrossed[part.source]);
      }
    }
    // Parts of one triangle that are not flipped do not cross.
    for (std::size_t p = 0; p < parts.size(); ++p) {
      if (isPart[p] != 0 && isFlipped(parts[p], sources[p])) return kRounding;
    }
    // Neither do those of the mesh, which does not cross itself here: only cracks are tested.
    std::vector<std::uint8_t> isOfCrack(parts.size(), 1);
    std::fill_n(isOfCrack.begin(), ofSurface, 0);
    const auto crossings =
        selfCrossings(vertices_, parts, progress, {.of = isOfCrack, .source = sources});
    if (crossings.empty()) return {};
    return crossings.front()[0] >= ofSurface ? "cracks cross each other" : kRounding;
  }

  // Whether a part faces away from its triangle of the mesh or, numbered after those, of the
  // cracks.
  bool isFlipped(const glm::uvec3& part, std::size_t source) const {
    const std::size_t count = source_.triangles.size();
    const glm::uvec3 whole = source < count
                                 ? source_.triangles[source]
                                 : cracks_.faces[source - count].corner +
                                       static_cast<std::uint32_t>(source_.vertices.size());
    const auto normalOf = [&](const glm::uvec3& t) {
      return glm::cross(vertices_[t.y] - vertices_[t.x], vertices_[t.z] - vertices_[t.x]);
    };
    const glm::dvec3 normal = normalOf(whole);
    const int axis = largestAxis(normal);
    const int side = orientation(ExactPoint(vertices_[part.x]), ExactPoint(vertices_[part.y]),
                                 ExactPoint(vertices_[part.z]), axis);
    return side * (normal[axis] > 0.0 ? 1 : -1) < 0;
  }

  ExactSurface assembled(const Patches& outside, const Patches& inside, const Progress* progress) {
    crackLabels_.reserve(inside.parts().size());
    for (const Part& part : inside.parts()) {
      const ComplexFace& crack = cracks_.faces[part.source];
      crackLabels_.push_back({crack.front, crack.back});
    }
    ExactSurface result;
    // An island may have only islands beside it, so that more than one round is needed.  Two that
    // touch each other most would change places for ever: where there are no fewer of them than in
    // the round before, only islands that do not touch are given away, each of which becomes a part
    // of what it touches.
    std::size_t before = std::numeric_limits<std::size_t>::max();
    bool isOneByOne = false;
    for (;;) {
      throwIfCancelled(progress);
      const std::vector<std::vector<Face>> faces = facesOf(outside, inside);
      result.meshes.assign(fragments_, {});
      std::vector<std::uint8_t> isClosed(fragments_, 1);
      tbb::parallel_for(std::size_t{0}, fragments_, [&](std::size_t i) {
        result.meshes[i] = meshOf(faces[i + 1]);
        isClosed[i] = makeManifold(result.meshes[i]) ? 1 : 0;
      });
      const auto open = std::find(isClosed.begin(), isClosed.end(), 0);
      if (open != isClosed.end()) {
        return {.failure = "the cracks do not close fragment " +
                           std::to_string(open - isClosed.begin() + 1),
                .isDegenerate = true};
      }
      std::vector<Island> islands = islandsOf(result.meshes, faces);
      if (islands.empty()) return result;
      isOneByOne = isOneByOne || islands.size() >= before;
      before = islands.size();
      giveAway(isOneByOne ? apart(std::move(islands)) : std::move(islands), result.moved);
    }
  }

  // Returns [fragments + 1] the faces of each.
  std::vector<std::vector<Face>> facesOf(const Patches& outside, const Patches& inside) const {
    std::vector<std::vector<Face>> faces(fragments_ + 1);
    const auto add = [&](std::uint16_t label, const Face& face) {
      if (label != 0 && label <= fragments_) faces[label].push_back(face);
    };
    for (std::uint32_t p = 0; p < outside.parts().size(); ++p) {
      const Part& part = outside.parts()[p];
      add(label_[p], {part.corner, part.source, 0, p});
    }
    for (std::uint32_t p = 0; p < inside.parts().size(); ++p) {
      const auto& [front, back] = crackLabels_[p];
      if (!isInside_[p] || front == back) continue;
      const glm::uvec3& t = inside.parts()[p].corner;
      add(front, {t, TriangleMesh::kNoSource, back, p});
      add(back, {{t.x, t.z, t.y}, TriangleMesh::kNoSource, front, p, 1});
    }
    return faces;
  }

  // A component of a fragment's mesh that another fragment gets.
  struct Island {
    std::uint16_t from = 0, heir = 0;
    std::vector<Face> faces;
  };

  // A fragment's voxels are connected, so that components of its mesh beside the largest are mostly
  // slivers where a crack grazes the surface, and else what less than a voxel connects.  They go to
  // the fragment that they touch most.
  static std::vector<Island> islandsOf(const std::vector<LabeledMesh>& meshes,
                                       const std::vector<std::vector<Face>>& faces) {
    std::vector<Island> islands;
    for (std::size_t i = 0; i < meshes.size(); ++i) {
      const TriangleMesh& mesh = meshes[i].mesh;
      const MeshComponents components = meshComponents(mesh);
      if (components.count < 2) continue;
      std::vector<double> volumes(components.count, 0.0);
      std::vector<std::map<std::uint16_t, double>> contacts(components.count);
      const glm::dvec3 origin = mesh.vertices.front();
      for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const glm::uvec3& corner = mesh.triangles[t];
        const glm::dvec3 a = mesh.vertices[corner.x] - origin;
        const glm::dvec3 b = mesh.vertices[corner.y] - origin;
        const glm::dvec3 c = mesh.vertices[corner.z] - origin;
        const std::uint32_t component = components.ofTriangle[t];
        volumes[component] += glm::dot(a, glm::cross(b, c));
        const std::uint16_t other = meshes[i].other[t];
        if (other != 0) contacts[component][other] += glm::length(glm::cross(b - a, c - a));
      }
      const auto largest = static_cast<std::size_t>(
          std::max_element(volumes.begin(), volumes.end()) - volumes.begin());
      std::vector<std::size_t> islandOf(components.count, kNoIsland);
      for (std::size_t k = 0; k < components.count; ++k) {
        // A cavity's surface has a negative volume; a body apart touches no crack.
        if (k == largest || volumes[k] <= 0.0 || contacts[k].empty()) continue;
        islandOf[k] = islands.size();
        const auto most = std::max_element(contacts[k].begin(), contacts[k].end(),
                                           [](auto& a, auto& b) { return a.second < b.second; });
        islands.push_back({static_cast<std::uint16_t>(i + 1), most->first, {}});
      }
      for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const std::size_t island = islandOf[components.ofTriangle[t]];
        if (island != kNoIsland) islands[island].faces.push_back(faces[i + 1][t]);
      }
    }
    return islands;
  }

  // Returns those that touch none of the others that are returned.
  std::vector<Island> apart(std::vector<Island> islands) const {
    std::vector<Island> found;
    std::vector<std::array<bool, 2>> isTaken(crackLabels_.size(), {false, false});
    for (Island& island : islands) {
      const auto ofCracks = [&](const auto& visit) {
        for (const Face& face : island.faces) {
          if (face.neighbor != 0) visit(isTaken[face.part], face.side);
        }
      };
      bool touches = false;
      ofCracks([&](const auto& taken, std::uint8_t side) { touches |= taken[1u - side]; });
      if (touches) continue;
      ofCracks([](auto& taken, std::uint8_t side) { taken[side] = true; });
      found.push_back(std::move(island));
    }
    return found;
  }

  void giveAway(const std::vector<Island>& islands, std::vector<MovedBody>& moved) {
    for (const Island& island : islands) {
      moved.push_back({island.from, island.heir, meshOf(island.faces).mesh});
      for (const Face& face : island.faces) {
        if (face.neighbor == 0) {
          label_[face.part] = island.heir;
        } else {
          crackLabels_[face.part][face.side] = island.heir;
        }
      }
    }
  }

  LabeledMesh meshOf(const std::vector<Face>& faces) const {
    std::vector<std::uint32_t> used;
    used.reserve(3 * faces.size());
    for (const Face& face : faces)
      used.insert(used.end(), {face.corner.x, face.corner.y, face.corner.z});
    const VertexNumbers numbers(std::move(used), vertices_.size());
    LabeledMesh out;
    out.positionId.assign(numbers.vertices().begin(), numbers.vertices().end());
    out.mesh.vertices.reserve(out.positionId.size());
    for (const std::uint32_t v : out.positionId) out.mesh.vertices.push_back(vertices_[v]);
    out.mesh.triangles.reserve(faces.size());
    out.mesh.source.reserve(faces.size());
    out.other.reserve(faces.size());
    for (const Face& face : faces) {
      out.mesh.triangles.emplace_back(numbers.of(face.corner.x), numbers.of(face.corner.y),
                                      numbers.of(face.corner.z));
      out.other.push_back(face.neighbor);
      out.mesh.source.push_back(face.source);
    }
    return out;
  }

  const TriangleMesh& source_;
  const LabeledComplex& cracks_;
  const std::size_t fragments_;
  const SpaceLabels& space_;
  std::vector<std::uint32_t> flat_;
  std::vector<glm::dvec3> vertices_;  // the source's, the cracks', those of crossings
  std::vector<std::uint16_t> label_;  // [parts of the source]
  std::vector<bool> isInside_;        // [parts of the cracks]
  std::vector<std::array<std::uint16_t, 2>> crackLabels_;  // [parts of the cracks] front, back
};

}  // namespace

ExactSurface exactSurface(const TriangleMesh& source, const LabeledComplex& cracks,
                          std::size_t fragments, const SpaceLabels& space,
                          const Progress* progress) {
  FragmentAssembler assembly(source, cracks, fragments, space);
  ExactSurface surface = assembly.assemble(progress);
  if (assembly.flat().empty()) return surface;
  const TriangleMesh mended = withoutFlat(source, assembly.flat());
  if (mended.triangles.empty()) return surface;
  surface = FragmentAssembler(mended, cracks, fragments, space).assemble(progress);
  for (LabeledMesh& mesh : surface.meshes) {
    for (std::uint32_t& from : mesh.mesh.source) {
      if (from != TriangleMesh::kNoSource) from = mended.source[from];
    }
  }
  return surface;
}

}  // namespace sherd
