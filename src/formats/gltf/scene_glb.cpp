// Writes scenes as binary glTF with rigid bodies.
#include <utility>

#include "base/cancel_flag.h"
#include "formats/gltf/glb_file.h"
#include "formats/gltf/glb_materials.h"
#include "formats/gltf/glb_mesh.h"
#include "formats/mesh/joint_strength.h"
#include "formats/mesh/scene.h"
#include "mesh/principal_inertia.h"

namespace sherd {
namespace {

using OrderedJson = GlbFile::Json;

constexpr const char* kPhysics = "KHR_physics_rigid_bodies";
constexpr const char* kLevels = "MSFT_lod";

OrderedJson jsonOfVector(const glm::dvec3& v) { return {v.x, v.y, v.z}; }

// The extension's schema has no mass or inertia of 0: an engine derives them from the collider.
//   density  kilograms per cubic unit; moments of inertia are in kilograms and meters
OrderedJson motionOf(const MassProperties& mass, double density, double metersPerUnit) {
  const PrincipalInertia inertia = principalInertia(mass);
  const glm::dvec3 moments = density * metersPerUnit * metersPerUnit * inertia.moments;
  const glm::dquat& rotation = inertia.orientation;
  OrderedJson motion = {{"centerOfMass", jsonOfVector(glm::dvec3(0.0))}};
  if (mass.volume > 0.0) motion["mass"] = density * mass.volume;
  if (moments.x > 0.0 && moments.y > 0.0 && moments.z > 0.0) {
    motion["inertiaDiagonal"] = jsonOfVector(moments);
    motion["inertiaOrientation"] = {rotation.x, rotation.y, rotation.z, rotation.w};
  }
  return motion;
}

// Nodes are numbered: pieces first, then the meshes of those with several, then splits, then the
// two nodes of each joint.
class SceneWriter {
 public:
  SceneWriter(const FragmentScene& scene, const Progress* progress)
      : scene_(scene),
        progress_(progress),
        materials_(file_, scene.pieces.front().piece.materials),
        levels_(levelsOf(scene)) {}

  void write(const OutputFile& file) {
    for (const ScenePiece& piece : scene_.pieces) addPiece(piece);
    for (std::size_t i = 0; i < scene_.pieces.size(); ++i) addLevels(i);
    addSplits();
    addJoints();
    file_.extensionsUsed.insert(kPhysics);
    file_.write(file, nodesOf(levels_[0]), scene_.coordinates, scene_.name);
  }

 private:
  void addPiece(const ScenePiece& own) {
    throwIfCancelled(progress_);
    OrderedJson node = {{"name", own.piece.name}};
    if (own.coarse.empty()) node["mesh"] = meshOf(own, own.piece);
    node["translation"] = jsonOfVector(own.mass.centroid);
    node["extensions"] = {
        {kPhysics,
         {{"motion", motionOf(own.mass, scene_.densityOfUnits(), scene_.coordinates.metersPerUnit)},
          {"collider", {{"geometry", {{"node", file_.nodes.size()}, {"convexHull", true}}}}}}}};
    file_.nodes.push_back(std::move(node));
  }

  std::size_t meshOf(const ScenePiece& own, const PieceMesh& piece) {
    return scene_.plain ? addPlainGlbMesh(file_, piece.name, piece.mesh, own.mass.centroid)
                        : addGlbMesh(file_, materials_, piece, own.mass.centroid);
  }

  // Adds the nodes of a piece's meshes, if it has several.  Of the levels only the first is below
  // the piece: the extension names the others, which are in no scene.
  void addLevels(std::size_t i) {
    const ScenePiece& own = scene_.pieces[i];
    if (own.coarse.empty()) return;
    throwIfCancelled(progress_);
    const std::size_t first = file_.nodes.size();
    file_.nodes[i]["extensions"][kPhysics]["collider"]["geometry"]["node"] = first;
    file_.nodes[i]["children"].push_back(first);
    OrderedJson others = OrderedJson::array(), coverage = OrderedJson::array({0.5});
    for (std::size_t k = 0; k < own.coarse.size(); ++k) {
      others.push_back(first + 1 + k);
      coverage.push_back(k + 1 == own.coarse.size() ? 0.0 : coverage.back().get<double>() / 2.0);
    }
    file_.nodes.push_back({{"name", own.piece.name + "_" + lodName(0)},
                           {"mesh", meshOf(own, own.piece)},
                           {"extensions", {{kLevels, {{"ids", others}}}}},
                           {"extras", {{"MSFT_screencoverage", coverage}}}});
    for (std::size_t k = 0; k < own.coarse.size(); ++k) {
      file_.nodes.push_back(
          {{"name", own.piece.name + "_" + lodName(k + 1)}, {"mesh", meshOf(own, own.coarse[k])}});
    }
    file_.extensionsUsed.insert(kLevels);
  }

  // Returns the nodes of what is directly below a split, or the whole.
  [[nodiscard]] std::vector<std::size_t> nodesOf(const SceneLevel& level) const {
    std::vector<std::size_t> nodes = level.pieces;
    for (const std::size_t split : level.splits) nodes.push_back(nodeOfSplit_[split]);
    return nodes;
  }

  void addSplits() {
    nodeOfSplit_.resize(levels_.size());
    std::size_t next = file_.nodes.size();
    for (std::size_t split = 1; split < levels_.size(); ++split) {
      if (!levels_[split].empty()) nodeOfSplit_[split] = next++;
    }
    for (std::size_t split = 1; split < levels_.size(); ++split) {
      if (levels_[split].empty()) continue;
      file_.nodes.push_back({{"name", splitName(split)}, {"children", nodesOf(levels_[split])}});
    }
  }

  void addJoints() {
    const std::vector<SceneJoint> joints = jointsOf(scene_);
    if (joints.empty()) return;
    const OrderedJson none = {{"min", 0.0}, {"max", 0.0}};
    OrderedJson linear = {{"linearAxes", {0, 1, 2}}}, angular = {{"angularAxes", {0, 1, 2}}};
    linear.update(none);
    angular.update(none);
    file_.extensions[kPhysics] = {
        {"physicsJoints",
         OrderedJson::array(
             {{{"name", "fixed"}, {"limits", OrderedJson::array({linear, angular})}}})}};
    for (const SceneJoint& joint : joints) {
      throwIfCancelled(progress_);
      const std::size_t first = file_.nodes.size();
      OrderedJson node = frame(joint.one, joint.other, *joint.contact);
      node["extensions"] = {{kPhysics, {{"joint", {{"connectedNode", first + 1}, {"joint", 0}}}}}};
      node["extras"] = {{"area", joint.contact->area},
                        {"breakForce", jointStrength(*joint.contact, scene_.strengthOfUnits())}};
      file_.nodes.push_back(std::move(node));
      file_.nodes.push_back(frame(joint.other, joint.one, *joint.contact));
      file_.nodes[joint.one]["children"].push_back(first);
      file_.nodes[joint.other]["children"].push_back(first + 1);
    }
  }

  // Where a contact is, as seen from one of its pieces.
  [[nodiscard]] OrderedJson frame(std::size_t piece, std::size_t other,
                                  const Contact& contact) const {
    const ScenePiece& own = scene_.pieces[piece];
    return {
        {"name", "joint_" + std::to_string(own.id) + "_" + std::to_string(scene_.pieces[other].id)},
        {"translation", jsonOfVector(contact.centroid - own.mass.centroid)}};
  }

  const FragmentScene& scene_;
  const Progress* progress_;
  GlbFile file_;
  GlbMaterials materials_;
  const std::vector<SceneLevel> levels_;  // [1 + splits]
  std::vector<std::size_t> nodeOfSplit_;  // [1 + splits]
};

}  // namespace

void writeSceneGlb(const OutputFile& file, const FragmentScene& scene, const Progress* progress) {
  if (scene.pieces.empty()) return;
  SceneWriter(scene, progress).write(file);
}

}  // namespace sherd
