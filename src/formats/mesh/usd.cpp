// Writes scenes in Pixar's Universal Scene Description.
#include "formats/mesh/usd.h"

#include <sherd/error.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <limits>
#include <map>
#include <utility>

#include "base/cancel_flag.h"
#include "base/version.h"
#include "formats/arrays/zip_writer.h"
#include "formats/mesh/joint_strength.h"
#include "formats/mesh/usd_mesh.h"
#include "formats/mesh/usd_text.h"
#include "mesh/principal_inertia.h"

namespace sherd {
namespace {

// USDZ has no ZIP64; below 2^32 by what the directory may take.
constexpr std::uint64_t kMostOfArchive = std::numeric_limits<std::uint32_t>::max() - (1 << 20);

constexpr double kExploded = 0.5;  // of the distance from the center, how far pieces move away

std::string numbered(const char* name, double value) {
  std::string text = std::string(name) + " = ";
  appendShortest(text, value);
  return text;
}

std::string numbered(const char* name, float value) {
  std::string text = std::string(name) + " = ";
  appendFloat(text, value);
  return text;
}

// What is written below a split, or the whole: indices of pieces, and numbers of splits.
struct Level {
  std::vector<std::size_t> pieces{}, splits{};

  bool empty() const { return pieces.empty() && splits.empty(); }
};

// Returns [1 + splits] the levels, of which those of splits without pieces are in no other.  Beyond
// a depth the pieces of a split are those of the one that it comes from.
std::vector<Level> levelsOf(const UsdScene& scene) {
  constexpr std::size_t kDeepest = 32;
  const std::size_t count = scene.parentOfSplit.size() + 1;
  std::vector<std::size_t> depth(count, 0), shownIn(count, 0);
  for (std::size_t split = 1; split < count; ++split) {
    const std::size_t parent = scene.parentOfSplit[split - 1];
    depth[split] = depth[parent] + 1;
    shownIn[split] = depth[split] <= kDeepest ? split : shownIn[parent];
  }
  std::vector<Level> levels(count);
  for (std::size_t i = 0; i < scene.pieces.size(); ++i) {
    levels[shownIn[scene.pieces[i].split]].pieces.push_back(i);
  }
  for (std::size_t split = count - 1; split > 0; --split) {
    std::vector<std::size_t>& own = levels[split].splits;
    std::reverse(own.begin(), own.end());
    if (!levels[split].empty()) levels[scene.parentOfSplit[split - 1]].splits.push_back(split);
  }
  std::reverse(levels[0].splits.begin(), levels[0].splits.end());
  return levels;
}

// Writes one layer.
class Layer {
 public:
  ///   hasVolumes  of pieces that name one
  Layer(const UsdScene& scene, bool hasVolumes, const Progress* progress, const ByteSink& sink)
      : scene_(scene),
        progress_(progress),
        hasVolumes_(hasVolumes),
        text_(sink),
        root_(usdName(scene.name)),
        names_(scene.pieces.size()),
        paths_(scene.pieces.size()),
        levels_(levelsOf(scene)) {
    for (std::size_t i = 0; i < scene.pieces.size(); ++i) {
      names_[i] = usdName(scene.pieces[i].piece.name);
      indexOf_[scene.pieces[i].id] = i;
    }
  }

  void write() {
    text_.line("#usda 1.0");
    text_.line("(");
    text_.line("    defaultPrim = \"" + root_ + "\"");
    text_.line("    doc = " + usdString("Fragments, by Sherd " SHERD_VERSION));
    text_.line("    " + numbered("kilogramsPerUnit", 1.0));
    text_.line("    " + numbered("metersPerUnit", scene_.metersPerUnit));
    text_.line(scene_.up == 'z' ? "    upAxis = \"Z\"" : "    upAxis = \"Y\"");
    text_.line(")");
    text_.line("");
    text_.open("def Xform", root_,
               "\n    kind = \"component\"\n    variants = {\n        string preview = \"whole\"\n"
               "    }\n    prepend variantSets = \"preview\"\n");
    materials();
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
    materialNames_ = usdNames(table);
    text_.open("def Scope", "materials");
    for (std::uint32_t m = 0; m < table.materials.size(); ++m) material(table, m);
    text_.close();
  }

  void material(const MaterialTable& table, std::uint32_t number) {
    const MaterialTable::Entry& entry = table.materials[number];
    const std::string path = materialPath(number);
    const bool isInside = number == table.inside();
    const SurfaceAttributes& attributes = scene_.pieces.front().piece.attributes;
    const bool isTextured =
        !isInside && entry.texture >= 0 && !attributes.texcoords.empty() &&
        table.textures[static_cast<std::size_t>(entry.texture)].type != ImageType::other;
    const bool isColored = !isTextured && !attributes.colors.empty();
    text_.open("def Material", materialNames_[number]);
    text_.line("token outputs:surface.connect = <" + path + "/surface.outputs:surface>");
    text_.open("def Shader", "surface");
    text_.line("uniform token info:id = \"UsdPreviewSurface\"");
    if (isTextured) {
      text_.line("color3f inputs:diffuseColor.connect = <" + path + "/texture.outputs:rgb>");
    } else if (isColored) {
      text_.line("color3f inputs:diffuseColor.connect = <" + path + "/color.outputs:result>");
    } else {
      const glm::vec3 color = isInside ? linearFromSrgb(kInsideColor) : entry.color;
      text_.line("color3f inputs:diffuseColor = " + usdVector(color));
    }
    text_.line("float inputs:metallic = 0");
    text_.line("float inputs:roughness = 1");
    text_.line("token outputs:surface");
    text_.close();
    if (isTextured) {
      texture(table.textures[static_cast<std::size_t>(entry.texture)].file, entry.color, path);
    }
    if (isColored) reader("color", "float3", "displayColor");
    text_.close();
  }

  void texture(const std::string& file, const glm::vec3& color, const std::string& path) {
    text_.open("def Shader", "texture");
    text_.line("uniform token info:id = \"UsdUVTexture\"");
    text_.line("asset inputs:file = " + usdAsset("./" + scene_.textureFolder + file));
    std::string scale = usdVector(color);
    scale.insert(scale.size() - 1, ", 1");
    text_.line("float4 inputs:scale = " + scale);
    text_.line("token inputs:sourceColorSpace = \"sRGB\"");
    text_.line("float2 inputs:st.connect = <" + path + "/st.outputs:result>");
    text_.line("token inputs:wrapS = \"repeat\"");
    text_.line("token inputs:wrapT = \"repeat\"");
    text_.line("float3 outputs:rgb");
    text_.close();
    reader("st", "float2", "st");
  }

  void reader(const std::string& name, const std::string& type, const std::string& primvar) {
    text_.open("def Shader", name);
    text_.line("uniform token info:id = \"UsdPrimvarReader_" + type + "\"");
    text_.line("string inputs:varname = \"" + primvar + "\"");
    text_.line(type + " outputs:result");
    text_.close();
  }

  // No name of a piece, which ends in '_' and digits.
  static std::string splitName(std::size_t split) { return "split" + std::to_string(split); }

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
    const UsdPiece& own = scene_.pieces[i];
    paths_[i] = parent + "/" + names_[i];
    const PrincipalInertia inertia = principalInertia(own.mass);
    text_.open("def Xform", names_[i],
               "\n    prepend apiSchemas = [\"PhysicsRigidBodyAPI\", \"PhysicsMassAPI\"]\n");
    text_.line("point3f physics:centerOfMass = (0, 0, 0)");
    text_.line("float3 physics:diagonalInertia = " +
               usdVector(glm::vec3(scene_.density * inertia.moments)));
    text_.line(
        numbered("float physics:mass", static_cast<float>(scene_.density * own.mass.volume)));
    text_.line("quatf physics:principalAxes = " + usdRotation(inertia.orientation));
    text_.line("double3 xformOp:translate = " + usdVector(own.mass.centroid));
    text_.line("double3 xformOp:translate:apart");  // a value here would hide the variants'
    text_.line(
        "uniform token[] xformOpOrder = [\"xformOp:translate:apart\", \"xformOp:translate\"]");
    writeUsdMesh(text_, names_[i], own.piece, own.mass.centroid,
                 [this](std::uint32_t number) { return materialPath(number); });
    if (hasVolumes_ && !own.volume.empty()) volume(i);
    text_.close();
  }

  // The level set, whose grid is in the coordinates of the input.
  void volume(std::size_t i) {
    const UsdPiece& own = scene_.pieces[i];
    text_.open("def Volume", "volume");
    text_.line(usdExtent(own.piece.mesh, glm::dvec3(0.0)));
    text_.line("rel field:surface = <" + paths_[i] + "/volume/surface>");
    text_.line("token visibility = \"invisible\"");
    text_.line("double3 xformOp:translate = " + usdVector(-own.mass.centroid));
    text_.line("uniform token[] xformOpOrder = [\"xformOp:translate\"]");
    text_.open("def OpenVDBAsset", "surface");
    text_.line("token fieldName = \"surface\"");
    text_.line("asset filePath = " + usdAsset("./" + own.volume));
    text_.close();
    text_.close();
  }

  void joints() {
    text_.open("def Scope", "joints");
    for (std::size_t i = 0; i < scene_.pieces.size(); ++i) {
      const UsdPiece& own = scene_.pieces[i];
      for (const Contact& contact : own.contacts) {
        const auto other = indexOf_.find(contact.fragment);
        if (contact.fragment > own.id && other != indexOf_.end()) {
          joint(i, other->second, contact);
        }
      }
    }
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
    text_.line(numbered("float physics:breakForce", jointStrength(contact, scene_.strength)));
    text_.line("point3f physics:localPos0 = " + local(one));
    text_.line("point3f physics:localPos1 = " + local(other));
    text_.line("quatf physics:localRot0 = (1, 0, 0, 0)");
    text_.line("quatf physics:localRot1 = (1, 0, 0, 0)");
    text_.close();
  }

  void variants() {
    glm::dvec3 center(0.0);
    double volume = 0.0;
    for (const UsdPiece& own : scene_.pieces) {
      center += own.mass.volume * own.mass.centroid;
      volume += own.mass.volume;
    }
    if (volume > 0.0) center /= volume;
    text_.line("variantSet \"preview\" = {");
    variant("exploded",
            [&](const UsdPiece& own) { return kExploded * (own.mass.centroid - center); });
    variant("whole", [](const UsdPiece&) { return glm::dvec3(0.0); });
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

  const UsdScene& scene_;
  const Progress* progress_;
  const bool hasVolumes_;
  UsdText text_;
  const std::string root_;
  std::vector<std::string> names_, paths_;  // [pieces]
  std::vector<std::string> materialNames_;  // [materials]
  const std::vector<Level> levels_;         // [1 + splits]
  std::map<int, std::size_t> indexOf_;      // by id
};

}  // namespace

void writeUsda(const OutputFile& file, const UsdScene& scene, const Progress* progress) {
  if (scene.pieces.empty()) return;
  file.write([&](const ByteSink& sink) { Layer(scene, true, progress, sink).write(); });
}

void writeUsdz(const OutputFile& file, const UsdScene& scene, const Progress* progress) {
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
      if (image.type == ImageType::other) continue;
      add(scene.textureFolder + image.file, [&](const ByteSink& to) { to(image.bytes); });
    }
    zip.finish();
  });
}

}  // namespace sherd
