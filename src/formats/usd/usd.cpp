// Writes scenes in Pixar's Universal Scene Description.
#include "formats/usd/usd.h"

#include <sherd/error.h>

#include <cmath>
#include <functional>
#include <glm/common.hpp>
#include <limits>
#include <utility>

#include "base/cancel_flag.h"
#include "base/version.h"
#include "formats/arrays/zip_writer.h"
#include "formats/mesh/identifiers.h"
#include "formats/mesh/joint_strength.h"
#include "formats/usd/usd_material.h"
#include "formats/usd/usd_mesh.h"
#include "formats/usd/usd_text.h"
#include "mesh/principal_inertia.h"

namespace sherd {
namespace {

// In single precision; 0, for which simulators compute it, where that is infinite.
float single(double value) {
  const auto rounded = static_cast<float>(value);
  return std::isfinite(rounded) ? rounded : 0.0f;
}

// USDZ has no ZIP64; below 2^32 by what the directory may take.
constexpr std::uint64_t kMostOfArchive = std::numeric_limits<std::uint32_t>::max() - (1 << 20);

constexpr double kExploded = 0.5;  // of the distance from the center, how far pieces move away

// Writes one layer.
class Layer {
 public:
  ///   hasVolumes  of pieces that name one
  Layer(const FragmentScene& scene, bool hasVolumes, const Progress* progress, const ByteSink& sink)
      : scene_(scene),
        progress_(progress),
        hasVolumes_(hasVolumes),
        text_(sink),
        root_(identifierOf(scene.name)),
        names_(scene.pieces.size()),
        paths_(scene.pieces.size()),
        levels_(levelsOf(scene)) {
    for (std::size_t i = 0; i < scene.pieces.size(); ++i) {
      names_[i] = identifierOf(scene.pieces[i].piece.name);
    }
  }

  void write() {
    text_.line("#usda 1.0");
    text_.line("(");
    text_.line("    defaultPrim = \"" + root_ + "\"");
    text_.line("    doc = " + usdString("Fragments, by Sherd " SHERD_VERSION));
    text_.line("    " + usdNumber("kilogramsPerUnit", 1.0));
    text_.line("    " + usdNumber("metersPerUnit", scene_.coordinates.metersPerUnit));
    text_.line(scene_.coordinates.up == 'z' ? "    upAxis = \"Z\"" : "    upAxis = \"Y\"");
    text_.line(")");
    text_.line("");
    text_.open("def Xform", root_,
               "\n    kind = \"component\"\n    variants = {\n        string preview = \"whole\"\n"
               "    }\n    prepend variantSets = \"preview\"\n");
    if (scene_.coordinates.up == 'x') {  // no axis of USD's: rotated to y
      text_.line("quatf xformOp:orient = (0.5, 0.5, 0.5, 0.5)");
      text_.line("uniform token[] xformOpOrder = [\"xformOp:orient\"]");
    }
    if (!scene_.plain) materials();
    text_.open("def Xform", "pieces");
    children(0, "/" + root_ + "/pieces");
    text_.close();
    joints();
    variants();
    text_.close();
    text_.finish();
  }

 private:
  [[nodiscard]] std::string materialPath(std::uint32_t number) const {
    return "/" + root_ + "/materials/" + materialNames_[number];
  }

  void materials() {
    const MaterialTable& table = scene_.pieces.front().piece.materials;
    materialNames_ = identifiersOf(table);
    text_.open("def Scope", "materials");
    for (std::uint32_t m = 0; m < table.materials.size(); ++m) {
      writeUsdMaterial(text_, materialPath(m), table, m, scene_.pieces.front().piece.attributes,
                       scene_.textureFolder);
    }
    text_.close();
  }

  // Writes what comes of a split, or 0 the whole, one below the other.
  void children(std::size_t split, const std::string& path) {
    for (const std::size_t i : levels_[split].pieces) piece(i, path);
    for (const std::size_t other : levels_[split].splits) {
      const std::string name = splitName(other);
      text_.open("def Xform", name);
      children(other, path + "/" + name);
      text_.close();
    }
  }

  void piece(std::size_t i, const std::string& parent) {
    throwIfCancelled(progress_);
    const ScenePiece& own = scene_.pieces[i];
    paths_[i] = parent + "/" + names_[i];
    const PrincipalInertia inertia = principalInertia(own.mass);
    const std::string levels = "    variants = {\n        string lod = \"" + lodName(0) +
                               "\"\n    }\n    prepend variantSets = \"lod\"\n";
    text_.open("def Xform", names_[i],
               "\n    prepend apiSchemas = [\"PhysicsRigidBodyAPI\", \"PhysicsMassAPI\"]\n" +
                   (own.coarse.empty() ? std::string() : levels));
    text_.line("point3f physics:centerOfMass = (0, 0, 0)");
    text_.line("float3 physics:diagonalInertia = " +
               usdVector(glm::vec3(single(scene_.densityOfUnits() * inertia.moments.x),
                                   single(scene_.densityOfUnits() * inertia.moments.y),
                                   single(scene_.densityOfUnits() * inertia.moments.z))));
    text_.line(usdNumber("float physics:mass", single(scene_.densityOfUnits() * own.mass.volume)));
    text_.line("quatf physics:principalAxes = " + usdRotation(inertia.orientation));
    text_.line("double3 xformOp:translate = " + usdVector(own.mass.centroid));
    text_.line("double3 xformOp:translate:apart");  // a value here would hide the variants'
    text_.line(
        "uniform token[] xformOpOrder = [\"xformOp:translate:apart\", \"xformOp:translate\"]");
    meshes(i);
    if (hasVolumes_ && !own.volume.empty()) volume(i);
    text_.close();
  }

  // The mesh, or a variant with each of several.
  void meshes(std::size_t i) {
    const ScenePiece& own = scene_.pieces[i];
    const auto mesh = [&](const PieceMesh& piece) {
      std::function<std::string(std::uint32_t)> path;
      if (!scene_.plain) path = [this](std::uint32_t number) { return materialPath(number); };
      writeUsdMesh(text_, names_[i], piece, own.mass.centroid, path);
    };
    if (own.coarse.empty()) return mesh(own.piece);
    text_.line("variantSet \"lod\" = {");
    for (std::size_t k = 0; k <= own.coarse.size(); ++k) {
      text_.line("    \"" + lodName(k) + "\" {");
      mesh(k == 0 ? own.piece : own.coarse[k - 1]);
      text_.line("    }");
    }
    text_.line("}");
  }

  // The level set, whose grid is in the coordinates of the input, in the file's unit.
  void volume(std::size_t i) {
    const ScenePiece& own = scene_.pieces[i];
    text_.open("def Volume", "volume");
    const double unit = own.volumeUnit;
    text_.line(usdExtent(own.piece.mesh, glm::dvec3(0.0), unit));
    text_.line("rel field:surface = <" + paths_[i] + "/volume/surface>");
    text_.line("token visibility = \"invisible\"");
    text_.line("double3 xformOp:translate = " + usdVector(-own.mass.centroid));
    if (unit != 1.0) text_.line("double3 xformOp:scale = " + usdVector(glm::dvec3(unit)));
    text_.line(std::string("uniform token[] xformOpOrder = [\"xformOp:translate\"") +
               (unit == 1.0 ? "]" : ", \"xformOp:scale\"]"));
    text_.open("def OpenVDBAsset", "surface");
    text_.line("token fieldName = \"surface\"");
    text_.line("asset filePath = " + usdAsset("./" + own.volume));
    text_.close();
    text_.close();
  }

  void joints() {
    text_.open("def Scope", "joints");
    for (const SceneJoint& own : jointsOf(scene_)) joint(own.one, own.other, *own.contact);
    text_.close();
  }

  void joint(std::size_t one, std::size_t other, const Contact& contact) {
    const auto local = [&](std::size_t i) {
      return usdVector(glm::vec3(contact.centroid - scene_.pieces[i].mass.centroid));
    };
    text_.open("def PhysicsFixedJoint", "joint_" + std::to_string(scene_.pieces[one].id) + "_" +
                                            std::to_string(scene_.pieces[other].id));
    text_.line("rel physics:body0 = <" + paths_[one] + ">");
    text_.line("rel physics:body1 = <" + paths_[other] + ">");
    text_.line(usdNumber("float physics:breakForce",
                         static_cast<float>(jointStrength(contact, forceOfUnits()))));
    text_.line("point3f physics:localPos0 = " + local(one));
    text_.line("point3f physics:localPos1 = " + local(other));
    text_.line("quatf physics:localRot0 = (1, 0, 0, 0)");
    text_.line("quatf physics:localRot1 = (1, 0, 0, 0)");
    text_.close();
  }

  // Forces are in kilograms, seconds and units of length: newtons are that many by the meters of
  // one.
  [[nodiscard]] double forceOfUnits() const {
    return scene_.strengthOfUnits() / scene_.coordinates.metersPerUnit;
  }

  void variants() {
    glm::dvec3 center(0.0);
    double volume = 0.0;
    for (const ScenePiece& own : scene_.pieces) {
      center += own.mass.volume * own.mass.centroid;
      volume += own.mass.volume;
    }
    if (volume > 0.0) center /= volume;
    text_.line("variantSet \"preview\" = {");
    variant("exploded",
            [&](const ScenePiece& own) { return kExploded * (own.mass.centroid - center); });
    variant("whole", [](const ScenePiece&) { return glm::dvec3(0.0); });
    text_.line("}");
  }

  template <class ShiftOf>
  void variant(const std::string& name, const ShiftOf& shiftOf) {
    text_.line("    \"" + name + "\" {");
    if (name != "whole") text_.line("        over \"joints\" (active = false) {}");
    text_.open("over", "pieces");
    shifts(0, shiftOf);
    text_.close();
    text_.line("    }");
  }

  template <class ShiftOf>
  void shifts(std::size_t split, const ShiftOf& shiftOf) {
    for (const std::size_t i : levels_[split].pieces) {
      text_.open("over", names_[i]);
      text_.line("double3 xformOp:translate:apart = " + usdVector(shiftOf(scene_.pieces[i])));
      text_.close();
    }
    for (const std::size_t other : levels_[split].splits) {
      text_.open("over", splitName(other));
      shifts(other, shiftOf);
      text_.close();
    }
  }

  const FragmentScene& scene_;
  const Progress* progress_;
  const bool hasVolumes_;
  UsdText text_;
  const std::string root_;
  std::vector<std::string> names_, paths_;  // [pieces]
  std::vector<std::string> materialNames_;  // [materials]
  const std::vector<SceneLevel> levels_;    // [1 + splits]
};

}  // namespace

void writeUsda(const OutputFile& file, const FragmentScene& scene, const Progress* progress) {
  if (scene.pieces.empty()) return;
  file.write([&](const ByteSink& sink) { Layer(scene, true, progress, sink).write(); });
}

void writeUsdz(const OutputFile& file, const FragmentScene& scene, const Progress* progress) {
  if (scene.pieces.empty()) return;
  constexpr std::uint64_t kAlignment = 64;  // of the bytes of every file in it
  file.write([&](const ByteSink& sink) {
    ZipWriter zip(sink, kAlignment);
    // Written twice, as its size and sum precede it, and it may be larger than memory.
    const auto add = [&](std::string name, const Content& content) {
      const PackedFile packedFile =
          packed(std::move(name), false, content, [](std::string_view) {});
      if (zip.offset() + packedFile.size > kMostOfArchive) {
        throw Error(ErrorCode::output,
                    file.string() + ": would have more than 2^32 bytes, which USDZ cannot hold");
      }
      zip.begin(packedFile, packedFile.size);
      content(sink);
    };
    add("scene.usda", [&](const ByteSink& to) { Layer(scene, false, progress, to).write(); });
    for (const MaterialTable::Image& image : scene.pieces.front().piece.materials.textures) {
      if (scene.plain || image.type == ImageType::other) continue;
      add(scene.textureFolder + image.file, [&](const ByteSink& to) { to(image.bytes); });
    }
    zip.finish();
  });
}

}  // namespace sherd
