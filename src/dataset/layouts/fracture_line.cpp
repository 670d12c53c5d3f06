// The journal line of a fracture.
#include "dataset/layouts/fracture_line.h"

#include <algorithm>
#include <cmath>
#include <glm/vec4.hpp>
#include <numbers>

#include "base/random.h"
#include "base/text/json_of.h"
#include "dataset/layouts/layout.h"
#include "surface/fragment_surfaces.h"

namespace sherd {
namespace {

// A uniform random rotation as a quaternion: w, x, y, z.
// source  Shoemake, Uniform Random Rotations, Graphics Gems III, 1992
std::array<double, 4> randomRotation(std::uint64_t seed, int id) {
  const auto draw = [&](std::uint64_t k) {
    return randomUnit(seed, Stage::datasetPose, static_cast<std::uint64_t>(id) * 4 + k);
  };
  const double u = draw(0), a = 2.0 * std::numbers::pi * draw(1),
               b = 2.0 * std::numbers::pi * draw(2);
  return {std::sqrt(u) * std::cos(b), std::sqrt(1.0 - u) * std::sin(a),
          std::sqrt(1.0 - u) * std::cos(a), std::sqrt(u) * std::sin(b)};
}

// The pose moves p to rotation * (p - centroid).  The truth is its inverse: truth_rotation, then
// truth_translation.
Json poseJson(const Fragment& fragment, const UnitBox& frame, std::uint64_t seed) {
  const Json center = jsonOf(frame.of(fragment.mass.centroid));
  const auto [w, x, y, z] = randomRotation(seed, fragment.id);
  return {{"rotation", {w, x, y, z}},
          {"center", center},
          {"truth_rotation", {w, -x, -y, -z}},
          {"truth_translation", center}};
}

}  // namespace

FractureLine::FractureLine(const std::string& name, const PlannedFracture& planned,
                           std::uint64_t seed, int attempt, const DrawnValues& drawn)
    : seed_(seed),
      line_{{"fracture", name},
            {"pieces", planned.pieces},
            {"repeat", planned.repeat},
            {"attempt", attempt},
            {"seed", seed}} {
  Json options = Json::object();
  for (const auto& [option, value] : drawn) options[option] = value;
  line_["options"] = std::move(options);
}

void FractureLine::setOffset(const std::optional<glm::dvec3>& offset) {
  if (offset) line_["offset"] = jsonOf(*offset);
}

void FractureLine::setObjects(Json objects) { line_["objects"] = std::move(objects); }

void FractureLine::addFragments(const FractureResult& result, const FractureFiles& names,
                                const StagedFiles& files, const std::optional<UnitBox>& poses) {
  line_["labels"] = Json::array();
  for (const std::string& label : names.labels) line_["labels"].push_back(files.stored(label));
  line_["fragments"] = Json::array();
  const auto hasMesh = [](const Fragment& fragment) { return !fragment.mesh.vertices.empty(); };
  const bool isMeshed = std::ranges::any_of(result.fragments, hasMesh);
  std::vector<std::size_t> vertices;
  if (!isMeshed) vertices = result.surfaces->vertexCounts();
  for (std::size_t i = 0; i < result.fragments.size(); ++i) {
    const Fragment& fragment = result.fragments[i];
    Json own = {
        {"id", fragment.id},
        {"voxels", fragment.voxels},
        {"share", static_cast<double>(fragment.voxels) / static_cast<double>(result.solid.voxels)},
        {"volume", fragment.mass.volume},
        {"vertices", isMeshed ? fragment.mesh.vertices.size() : vertices[i + 1]},
        {"faces", isMeshed ? fragment.mesh.triangles.size()
                           : result.surfaces->triangles(static_cast<std::uint16_t>(i + 1))},
        {"contacts", Json::array()}};
    if (!result.objectOf.empty()) own["object"] = result.objectOf[i];
    for (const Contact& contact : fragment.contacts) {
      own["contacts"].push_back({contact.fragment, contact.area});
    }
    if (poses) own["pose"] = poseJson(fragment, *poses, seed_);
    if (i >= result.kept()) {
      own["withheld"] = true;
      own["files"] = Json::array();
    } else {
      own["files"] = Json::array();
      for (const std::string& file : filesOfFragment(names, i)) {
        own["files"].push_back(files.stored(file));
      }
    }
    line_["fragments"].push_back(std::move(own));
  }
}

}  // namespace sherd
