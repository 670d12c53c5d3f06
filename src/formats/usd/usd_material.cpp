// Materials of a USD scene.
#include "formats/usd/usd_material.h"

#include <array>
#include <utility>
#include <vector>

#include "base/text/number_text.h"
#include "formats/mesh/material.h"

namespace sherd {
namespace {

std::string inputOf(const char* name, double value) {
  return usdNumber(std::string("float inputs:") + name, static_cast<float>(value));
}

std::string fourOf(const glm::dvec3& v, double last) {
  std::string text = usdVector(glm::vec3(v));
  text.pop_back();  // its parenthesis
  appendFloat(text += ", ", static_cast<float>(last));
  return text + ")";
}

// A use of an image.
struct TextureShader {
  const char* name = "";               // of the shader
  int image = -1;                      // of the table; -1: none
  std::vector<const char*> outputs{};  // their types and names
  glm::dvec3 scale{1.0};
  double alphaScale = 1.0;
  bool isNormal = false;  // 0..1 means -1..1
  bool isColor = false;   // in sRGB
};

class MaterialPrim {
 public:
  MaterialPrim(UsdText& text, std::string path, const MaterialTable& table, std::uint32_t number,
               const SurfaceAttributes& attributes, const std::string& textureFolder)
      : text_(text),
        path_(std::move(path)),
        table_(table),
        entry_(table.materials[number]),
        pbr_(entry_.gltf.empty() ? PbrMaterial() : pbrOf(entry_.gltf)),
        hasTexcoords_(!attributes.texcoords.empty() && number != table.inside()),
        hasColors_(!attributes.colors.empty()),
        textureFolder_(textureFolder) {}

  void write() {
    TextureShader base{"texture", imageOf(entry_.texture), {}, entry_.color, pbr_.opacity, false,
                       true};
    if (pbr_.alpha != PbrMaterial::Alpha::opaque) base.outputs.push_back("float outputs:a");
    base.outputs.push_back("float3 outputs:rgb");
    const bool isColored = base.image < 0 && hasColors_;
    text_.open("def Material", path_.substr(path_.rfind('/') + 1));
    text_.line("token outputs:surface.connect = <" + path_ + "/surface.outputs:surface>");
    text_.open("def Shader", "surface");
    text_.line("uniform token info:id = \"UsdPreviewSurface\"");
    if (base.image >= 0) {
      connect("color3f", "diffuseColor", base.name, "rgb");
    } else if (isColored) {
      connect("color3f", "diffuseColor", "color", "result");
    } else {
      text_.line("color3f inputs:diffuseColor = " + usdVector(entry_.color));
    }
    surfaceInputs(base.image >= 0);
    text_.line("token outputs:surface");
    text_.close();
    textureShaders(base);
    if (isColored) reader("color", "float3", "displayColor");
    text_.close();
  }

 private:
  // Returns the image if it can be used, else -1.
  [[nodiscard]] int imageOf(int texture) const {
    const auto at = static_cast<std::size_t>(texture);
    const bool isUsable = texture >= 0 && hasTexcoords_ && at < table_.textures.size() &&
                          table_.textures[at].type != ImageType::other;
    return isUsable ? texture : -1;
  }

  void connect(const std::string& type, const std::string& input, const std::string& shader,
               const std::string& output) {
    text_.line(type + " inputs:" + input + ".connect = <" + path_ + "/" + shader +
               ".outputs:" + output + ">");
  }

  void surfaceInputs(bool hasBaseTexture) {
    const bool hasRoughness = imageOf(pbr_.roughnessTexture) >= 0;
    if (imageOf(pbr_.emissionTexture) >= 0) {
      connect("color3f", "emissiveColor", "emission", "rgb");
    } else if (pbr_.emission != glm::dvec3(0.0)) {
      text_.line("color3f inputs:emissiveColor = " + usdVector(glm::vec3(pbr_.emission)));
    }
    if (hasRoughness) {
      connect("float", "metallic", "roughness", "b");
    } else {
      text_.line(inputOf("metallic", pbr_.metallic));
    }
    if (imageOf(pbr_.normalTexture) >= 0) connect("normal3f", "normal", "normal", "rgb");
    if (imageOf(pbr_.occlusionTexture) >= 0) connect("float", "occlusion", "occlusion", "r");
    if (pbr_.alpha != PbrMaterial::Alpha::opaque) {
      if (hasBaseTexture) {
        connect("float", "opacity", "texture", "a");
      } else {
        text_.line(inputOf("opacity", pbr_.opacity));
      }
      if (pbr_.alpha == PbrMaterial::Alpha::mask) {
        text_.line(inputOf("opacityThreshold", pbr_.alphaCutoff));
      }
    }
    if (hasRoughness) {
      connect("float", "roughness", "roughness", "g");
    } else {
      text_.line(inputOf("roughness", pbr_.roughness));
    }
  }

  void textureShaders(const TextureShader& base) {
    const double scale = pbr_.normalScale;
    const std::array<TextureShader, 5> all{
        {base,
         {"emission",
          imageOf(pbr_.emissionTexture),
          {"float3 outputs:rgb"},
          pbr_.emission,
          1.0,
          false,
          true},
         {"normal",
          imageOf(pbr_.normalTexture),
          {"float3 outputs:rgb"},
          glm::dvec3(scale, scale, 1.0),
          1.0,
          true,
          false},
         {"occlusion", imageOf(pbr_.occlusionTexture), {"float outputs:r"}},
         {"roughness",
          imageOf(pbr_.roughnessTexture),
          {"float outputs:b", "float outputs:g"},
          glm::dvec3(1.0, pbr_.roughness, pbr_.metallic)}}};
    bool isTextured = false;
    for (const TextureShader& shader : all) {
      if (shader.image < 0) continue;
      isTextured = true;
      texture(shader);
    }
    if (isTextured) reader("st", "float2", "st");
  }

  void texture(const TextureShader& own) {
    const std::string& file = table_.textures[static_cast<std::size_t>(own.image)].file;
    const double factor = own.isNormal ? 2.0 : 1.0;
    text_.open("def Shader", own.name);
    text_.line("uniform token info:id = \"UsdUVTexture\"");
    if (own.isNormal) text_.line("float4 inputs:bias = " + fourOf(-own.scale, 0.0));
    text_.line("asset inputs:file = " + usdAsset("./" + textureFolder_ + file));
    text_.line("float4 inputs:scale = " + fourOf(factor * own.scale, own.alphaScale));
    text_.line(std::string("token inputs:sourceColorSpace = ") +
               (own.isColor ? "\"sRGB\"" : "\"raw\""));
    text_.line("float2 inputs:st.connect = <" + path_ + "/st.outputs:result>");
    text_.line("token inputs:wrapS = \"repeat\"");
    text_.line("token inputs:wrapT = \"repeat\"");
    for (const char* const output : own.outputs) text_.line(output);
    text_.close();
  }

  void reader(const std::string& name, const std::string& type, const std::string& primvar) {
    text_.open("def Shader", name);
    text_.line("uniform token info:id = \"UsdPrimvarReader_" + type + "\"");
    text_.line("string inputs:varname = \"" + primvar + "\"");
    text_.line(type + " outputs:result");
    text_.close();
  }

  UsdText& text_;
  const std::string path_;
  const MaterialTable& table_;
  const MaterialTable::Entry& entry_;
  const PbrMaterial pbr_;
  const bool hasTexcoords_, hasColors_;
  const std::string& textureFolder_;
};

}  // namespace

void writeUsdMaterial(UsdText& text, const std::string& path, const MaterialTable& table,
                      std::uint32_t number, const SurfaceAttributes& attributes,
                      const std::string& textureFolder) {
  MaterialPrim(text, path, table, number, attributes, textureFolder).write();
}

}  // namespace sherd
