// The readers against any bytes: each file is read or refused with an Error, and nothing else
// happens.
//
// The first byte picks the format, the rest is the file.  (Leaks are not looked for here: Assimp
// leaks on some malformed files, and the program ends after one.)
#include <sherd/error.h>
#include <sherd/io.h>
#include <sherd/mesh.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "mesh/mtl.h"
#include "shapes.h"

namespace {

const std::vector<std::string> kFormats{"ply", "stl", "obj", "off", "gltf", "glb", "rle", "mtl"};

std::filesystem::path scratch(const std::string& extension) {
  const std::filesystem::path memory = "/dev/shm";
  const std::filesystem::path folder =
      std::filesystem::is_directory(memory) ? memory : std::filesystem::temp_directory_path();
  return folder / ("sherd-fuzz-" + std::to_string(getpid()) + "." + extension);
}

// What a reader returns must be what its header promises.
void check(bool holds) {
  if (!holds) std::abort();
}

// Whether an array has one entry for each triangle, or none.
template <class Entries>
bool fits(const Entries& entries, const sherd::SourceMesh& source) {
  return entries.empty() || entries.size() == source.mesh.triangles.size();
}

void checkLook(const sherd::SourceMesh& source) {
  const sherd::Appearance& look = source.appearance;
  check(fits(look.surface.texcoords, source) && fits(look.surface.colours, source) &&
        fits(look.surface.material, source));
  for (const auto& corners : look.surface.texcoords) {
    for (const glm::vec2& at : corners) check(std::isfinite(at.x) && std::isfinite(at.y));
  }
  for (const std::uint32_t material : look.surface.material) {
    check(material < look.materials.size());
  }
  for (const sherd::Material& material : look.materials) {
    check(material.texture < static_cast<int>(look.textures.size()));
  }
}

void readOne(std::uint8_t format, const char* data, std::size_t size) {
  const std::string& extension = kFormats[format % kFormats.size()];
  const std::filesystem::path file = scratch(extension);
  std::ofstream(file, std::ios::binary).write(data, static_cast<std::streamsize>(size));
  try {
    if (extension == "rle") {
      const sherd::RunLengthVoxels voxels = sherd::readRle(file);
      std::uint64_t sum = 0;
      for (const sherd::Run& run : voxels.runs) sum += run.length;
      check(sum == static_cast<std::uint64_t>(voxels.dims.x()) *
                       static_cast<std::uint64_t>(voxels.dims.y()) *
                       static_cast<std::uint64_t>(voxels.dims.z()));
    } else if (extension == "mtl") {
      std::map<std::string, sherd::MtlMaterial> materials;
      sherd::addMtl(std::string_view(data, size), materials);
    } else {
      const sherd::SourceMesh source = sherd::readMesh(file);
      checkLook(source);
      check(!source.mesh.triangles.empty());
      for (const glm::dvec3& v : source.mesh.vertices) {
        check(std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z));
      }
      for (const glm::uvec3& t : source.mesh.triangles) {
        check(std::max({t.x, t.y, t.z}) < source.mesh.vertices.size());
      }
    }
  } catch (const sherd::Error& e) {
    check(e.code() == sherd::ErrorCode::input && e.what()[0] != '\0');
  }
  std::filesystem::remove(file);
}

}  // namespace

#ifndef SHERD_FUZZ_STANDALONE

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size > 0) readOne(data[0], reinterpret_cast<const char*>(data + 1), size - 1);
  return 0;
}

#else

#include <iostream>
#include <random>

// Valid files, then the same with bytes changed, cut, doubled or moved.
int main() {
  const std::string ascii =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
      "z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 "
      "0 1 2\n";
  std::string stl(80, ' ');
  stl += std::string("\1\0\0\0", 4) + std::string(50, '\0');
  const std::vector<std::pair<std::uint8_t, std::string> > valid{
      {0, ascii},
      {1, stl},
      {1,
       "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 "
       "0\nendloop\nendfacet\n"
       "endsolid s\n"},
      {2, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf -1 -2 -3\n"},
      {3, "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"},
      {4,
       R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":36}],"meshes":[{"primitives":[{}]}]})"},
      {5, std::string("glTF\2\0\0\0\14\0\0\0", 12)},
      {0,
       "ply\nformat ascii 1.0\ncomment TextureFile a.png\ncomment material 0 m 0\n"
       "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
       "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty float s\n"
       "property float t\nelement face 1\nproperty list uchar int vertex_indices\n"
       "property list uchar float texcoord\nproperty int material\nend_header\n"
       "0 0 0 1 2 3 0 0\n1 0 0 4 5 6 0 1\n0 1 0 7 8 9 1 1\n3 0 1 2 6 0 0 1 0 1 1 0\n"},
      {2,
       "mtllib a.mtl\nv 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0\nvt 0 1\nvt 1 1\nvt 1 0\nusemtl m\n"
       "f 1/1 2/2/ 3/3\nusemtl n\nf -1/-1 -2/-2 -3//\n"},
      {4, R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],)"
          R"("buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,)"
          R"(AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}],"bufferViews":[{"buffer":0,)"
          R"("byteLength":36}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,)"
          R"("type":"VEC3"},{"bufferView":0,"componentType":5126,"count":3,"type":"VEC2"},)"
          R"({"bufferView":0,"componentType":5121,"count":3,"type":"VEC4","normalized":true}],)"
          R"("images":[{"bufferView":0,"mimeType":"image/png"},{"uri":"x.png"}],)"
          R"("textures":[{"source":0},{"source":1}],"materials":[{"name":"m",)"
          R"("pbrMetallicRoughness":{"baseColorTexture":{"index":1,"texCoord":0},)"
          R"("baseColorFactor":[1,0.5,0,1]}}],"meshes":[{"primitives":[{"attributes":)"
          R"({"POSITION":0,"TEXCOORD_0":1,"COLOR_0":2},"material":0}]}]})"},
      {7, "newmtl a\nKd 1 0.5 0\nmap_Kd -s 1 1 1 -clamp on a b.png\nnewmtl b\nKd 1\nmap_Kd\n"},
      {6, std::string("\1\0\0\0\1\0\0\0\2\0\0\0\1\0\2\0\0\0", 18)},
  };
  std::minstd_rand random(17);
  constexpr int kRounds = 4000;
  for (int round = 0; round < kRounds; ++round) {
    auto [format, bytes] = valid[static_cast<std::size_t>(round) % valid.size()];
    for (unsigned edits = random() % 4; edits > 0; --edits) {
      const std::size_t at = random() % bytes.size();
      switch (random() % 4) {
        case 0:
          bytes[at] = static_cast<char>(random());
          break;
        case 1:
          bytes.resize(at + 1);
          break;
        case 2:
          bytes.insert(at, bytes.substr(at, random() % 20));
          break;
        default:
          bytes[at] = "0123456789-.e \n"[random() % 15];
          break;
      }
    }
    readOne(format, bytes.data(), bytes.size());
  }
  std::cout << kRounds << " files read or refused\n";
}

#endif
