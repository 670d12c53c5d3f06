// The page of the viewer.
#include "viewer/page.h"

#include <sherd/files.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <span>
#include <string_view>

#include "base/cancel_flag.h"
#include "base/files/sha256.h"
#include "base/text/base64.h"
#include "base/text/json_of.h"
#include "chart/svg.h"
#include "viewer/encode.h"
#include "viewer/simplify.h"

namespace sherd {

std::span<const std::string_view> viewerFiles();  // in the order of CMakeLists.txt

namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kChunk = std::size_t{3} << 20;  // of meshes, in a <script>; divisible by 3
constexpr int kFewestCubes = 16;                      // along the box, of the coarsest meshes

/// The parts of the page that are files of src/viewer/page.
struct PageFiles {
  std::string_view html, style;
  std::string script;

  PageFiles() {
    const std::span<const std::string_view> files = viewerFiles();
    html = files[0];
    style = files[1];
    script = "'use strict';\n";
    for (const std::string_view file : files.subspan(2)) script += file;
  }
};

std::string sizeText(std::uint64_t bytes) {
  const std::uint64_t whole = bytes >> 20;
  return whole > 0 ? std::to_string(whole) + " MiB" : std::to_string(bytes) + " bytes";
}

std::size_t base64Bytes(std::size_t bytes) { return (bytes + 2) / 3 * 4; }

Box boxOf(const ViewerScene& scene) {
  std::optional<Box> all;
  for (const ViewerPiece& piece : scene.pieces) {
    if (piece.mesh == nullptr || piece.mesh->vertices.empty()) continue;
    const Box own = bounds(*piece.mesh);
    if (!all) all = own;
    all->min = glm::min(all->min, own.min);
    all->max = glm::max(all->max, own.max);
  }
  return all.value_or(Box{});
}

// ---- Meshes

/// The meshes of all pieces, as few cubes as the page's size allows.
struct EncodedPieces {
  std::vector<EncodedMesh> meshes;  ///< [pieces]
  int cubes = 0;                    ///< ClusteredVertices; 0: as they are

  [[nodiscard]] std::size_t bytes() const {
    return std::transform_reduce(meshes.begin(), meshes.end(), std::size_t{0}, std::plus<>(),
                                 [](const EncodedMesh& mesh) { return mesh.bytes.size(); });
  }
};

EncodedPieces encodedPieces(const ViewerScene& scene, const Box& box, int cubes,
                            const Progress* progress) {
  EncodedPieces encoded{std::vector<EncodedMesh>(scene.pieces.size()), cubes};
  std::optional<ClusteredVertices> clustered;
  if (cubes > 0) clustered.emplace(scene.pieces, box, cubes);
  const PositionGrid positions(box);
  const TexcoordGrid texcoords(scene);
  const ViewerArrays arrays(scene);
  tbb::parallel_for(std::size_t{0}, scene.pieces.size(), [&](std::size_t i) {
    throwIfCancelled(progress);
    const ViewerPiece& piece = scene.pieces[i];
    if (piece.mesh == nullptr) return;
    if (clustered) {
      const ClusteredVertices::Mesh own = clustered->of(piece);
      encoded.meshes[i] =
          encodedMesh(own.mesh, own.attributes, scene.materials, arrays, positions, texcoords);
    } else {
      static const SurfaceAttributes kNone;
      const SurfaceAttributes& own = piece.attributes == nullptr ? kNone : *piece.attributes;
      encoded.meshes[i] =
          encodedMesh(*piece.mesh, own, scene.materials, arrays, positions, texcoords);
    }
  });
  return encoded;
}

// Encodes with fewer cubes until the bytes fit.
EncodedPieces fitting(const ViewerScene& scene, const Box& box, std::uint64_t maxBytes,
                      const Progress* progress) {
  EncodedPieces encoded = encodedPieces(scene, box, 0, progress);
  int cubes = ClusteredVertices::kMostCubes;
  while (base64Bytes(encoded.bytes()) > maxBytes && cubes > kFewestCubes) {
    reportProgress(progress, "simplify", 0.0);
    if (encoded.cubes > 0) {  // triangles go by the square of the cubes
      const double over =
          static_cast<double>(base64Bytes(encoded.bytes())) / static_cast<double>(maxBytes);
      cubes = std::max(kFewestCubes,
                       static_cast<int>(0.97 * static_cast<double>(cubes) / std::sqrt(over)));
    }
    encoded = encodedPieces(scene, box, cubes, progress);
  }
  return encoded;
}

// ---- The scene as JSON

Json runsJson(const EncodedMesh& mesh) {
  Json runs = Json::array();
  for (const EncodedMesh::Run& run : mesh.runs) {
    runs.push_back({run.neighbor, run.material, run.triangles});
  }
  return runs;
}

Json pieceJson(const ViewerPiece& piece, const EncodedMesh& mesh) {
  Json contacts = Json::array();
  for (const ViewerPiece::Contact& contact : piece.contacts) {
    contacts.push_back({contact.fragment, plain(contact.area)});
  }
  Json json = {{"id", piece.id},
               {"vertices", mesh.vertices},
               {"faces", mesh.triangles},
               {"lines", mesh.lines},
               {"runs", runsJson(mesh)},
               {"voxels", piece.voxels},
               {"volume", plain(piece.volume)},
               {"share", piece.share},
               {"area", plain(piece.area)},
               {"fracture_area", plain(piece.fractureArea)},
               {"centroid", jsonOf(piece.centroid)},
               {"inertia", piece.inertia},
               {"contacts", std::move(contacts)}};
  if (piece.isMissing) json["missing"] = true;
  if (piece.split > 0) json["split"] = piece.split;
  return json;
}

Json sceneJson(const ViewerScene& scene, const Box& box, const EncodedPieces& encoded) {
  const PositionGrid positions(box);
  const ViewerArrays arrays(scene);
  Json json = {{"format", "sherd-viewer/1"}, {"title", scene.title},
               {"unit", scene.unit},         {"up", std::string(1, scene.up)},
               {"density", scene.density},   {"origin", jsonOf(positions.low)},
               {"step", positions.step},     {"size", jsonOf(box.max - box.min)},
               {"colors", arrays.colors}};
  if (arrays.texcoords) {
    const TexcoordGrid texcoords(scene);
    json["texcoords"] = {{"origin", {texcoords.low.x, texcoords.low.y}},
                         {"step", {texcoords.step.x, texcoords.step.y}}};
  }
  if (encoded.cubes > 0) json["simplified"] = encoded.cubes;
  json["bytes"] = encoded.bytes();
  json["materials"] = Json::array();
  for (const ViewerScene::Material& material : scene.materials) {
    json["materials"].push_back({{"color", {material.color.x, material.color.y, material.color.z}},
                                 {"texture", arrays.texcoords ? material.texture : -1},
                                 {"inside", material.isInside}});
  }
  json["textures"] = Json::array();
  for (const Texture& texture : scene.textures) {
    json["textures"].push_back(imageType(texture.bytes) == ImageType::png ? "image/png"
                                                                          : "image/jpeg");
  }
  json["splits"] = scene.splitParents;
  json["pieces"] = Json::array();
  for (std::size_t i = 0; i < scene.pieces.size(); ++i) {
    json["pieces"].push_back(pieceJson(scene.pieces[i], encoded.meshes[i]));
  }
  return json;
}

// ---- HTML

// The text of JSON in a <script>: without "<", no "</script>" and no "<!--" can be in it.
std::string scriptJson(const Json& json) {
  const std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  std::string safe;
  safe.reserve(text.size());
  for (const char c : text) {
    if (c == '<') {
      safe += "\\u003c";
    } else {
      safe += c;
    }
  }
  return safe;
}

// A <script> that browsers do not run.
//   kind  its class
std::string dataScript(const char* type, const char* kind, const std::string& text) {
  return std::string("<script type=\"application/") + type + "\" class=\"" + kind + "\">" + text +
         "</script>\n";
}

std::string meshScripts(const std::vector<EncodedMesh>& meshes) {
  std::string text, chunk;
  const auto flush = [&](std::size_t bytes) {
    if (bytes == 0) return;
    text += dataScript("octet-stream", "meshes", base64(chunk.substr(0, bytes)));
    chunk.erase(0, bytes);
  };
  for (const EncodedMesh& mesh : meshes) {
    for (std::size_t at = 0; at < mesh.bytes.size(); at += kChunk) {
      chunk.append(mesh.bytes, at, kChunk);
      while (chunk.size() >= kChunk) flush(kChunk);
    }
  }
  flush(chunk.size());
  return text;
}

// A source of a Content-Security-Policy: text whose checksum is this one.
std::string sourceOf(std::string_view text) {
  const std::string digits = sha256(text);
  std::string bytes;
  for (std::size_t i = 0; i + 1 < digits.size(); i += 2) {
    int value = 0;
    std::from_chars(digits.data() + i, digits.data() + i + 2, value, 16);
    bytes.push_back(static_cast<char>(value));
  }
  return "'sha256-" + base64(bytes) + "'";
}

// Replaces each {{name}} of the template once, so that no text is taken for another's name.
std::string filled(std::string_view html,
                   std::span<const std::pair<std::string_view, std::string>> texts) {
  std::string page;
  while (!html.empty()) {
    const std::size_t begin = html.find("{{"), end = html.find("}}");
    page += html.substr(0, begin);
    if (begin == std::string_view::npos || end == std::string_view::npos) break;
    const std::string_view name = html.substr(begin + 2, end - begin - 2);
    for (const auto& [key, text] : texts) {
      if (key == name) page += text;
    }
    html.remove_prefix(end + 2);
  }
  return page;
}

std::string policy(const PageFiles& files) {
  return "default-src 'none'; script-src " + sourceOf(files.script) + "; style-src " +
         sourceOf(files.style) + "; base-uri 'none'; form-action 'none'";
}

// Leaves out the textures if they alone would fill the page.
std::vector<std::string> limitTextures(ViewerScene& scene, std::uint64_t maxBytes) {
  const auto bytes = std::transform_reduce(
      scene.textures.begin(), scene.textures.end(), std::size_t{0}, std::plus<>(),
      [](const Texture& texture) { return base64Bytes(texture.bytes.size()); });
  if (bytes <= maxBytes / 2) return {};
  scene.textures.clear();
  for (ViewerScene::Material& material : scene.materials) material.texture = -1;
  return {"the textures take " + sizeText(bytes) +
          ", more than half of the page's size, and are left out"};
}

// Leaves out textures that browsers do not show.
void dropForeignTextures(ViewerScene& scene) {
  std::vector<Texture> kept;
  std::vector<int> number;  // [textures] in `kept`
  for (Texture& texture : scene.textures) {
    const bool isShown = imageType(texture.bytes) != ImageType::other;
    number.push_back(isShown ? static_cast<int>(kept.size()) : -1);
    if (isShown) kept.push_back(std::move(texture));
  }
  scene.textures = std::move(kept);
  for (ViewerScene::Material& material : scene.materials) {
    if (material.texture >= 0)
      material.texture = number[static_cast<std::size_t>(material.texture)];
  }
}

//   left  bytes for the meshes, of the page's
std::string simplifiedSentence(const EncodedPieces& encoded, std::uint64_t left,
                               std::uint64_t maxBytes) {
  const std::string cells = "cells of 1/" + std::to_string(encoded.cubes) + " of the object";
  const std::size_t bytes = base64Bytes(encoded.bytes());
  if (bytes <= left) {
    return "the meshes are simplified to " + cells + ", to fit into " + sizeText(maxBytes);
  }
  return "the meshes are simplified as far as possible, to " + cells + ", and take " +
         sizeText(bytes) + " instead of " + sizeText(left);
}

}  // namespace

ViewerPage viewerPage(const ViewerScene& given, std::uint64_t maxBytes, const Progress* progress) {
  ViewerScene scene = given;
  dropForeignTextures(scene);
  ViewerPage page;
  page.warnings = limitTextures(scene, maxBytes);
  std::string textures;
  for (const Texture& texture : scene.textures) {
    textures += dataScript("octet-stream", "texture", base64(texture.bytes));
  }
  const Box box = boxOf(scene);
  const std::uint64_t left = maxBytes - std::min<std::uint64_t>(maxBytes, textures.size());
  const EncodedPieces encoded = fitting(scene, box, left, progress);
  if (encoded.cubes > 0) page.warnings.push_back(simplifiedSentence(encoded, left, maxBytes));
  throwIfCancelled(progress);
  const PageFiles files;
  const std::pair<std::string_view, std::string> texts[] = {
      {"title", chart::escapedXml(scene.title)},
      {"policy", policy(files)},
      {"style", std::string(files.style)},
      {"scene", dataScript("json", "scene", scriptJson(sceneJson(scene, box, encoded)))},
      {"data", textures + meshScripts(encoded.meshes)},
      {"script", files.script}};
  page.html = filled(files.html, texts);
  return page;
}

}  // namespace sherd
