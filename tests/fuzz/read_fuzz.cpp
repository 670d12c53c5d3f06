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
#include <string>
#include <vector>

#include "shapes.h"

namespace {

const std::vector<std::string> kFormats{"ply", "stl", "obj", "off", "gltf", "glb", "rle"};

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
    } else {
      const sherd::SourceMesh source = sherd::readMesh(file);
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
