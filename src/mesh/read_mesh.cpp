// Reads a mesh file: bytes, unpacking, the check that it is whole, the format's reader, merging.
#include "mesh/read_mesh.h"

#include <sherd/error.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>

#include "io/sha256.h"
#include "lower_case.h"
#include "mesh/assimp_reader.h"
#include "mesh/completeness.h"
#include "mesh/file_bytes.h"
#include "mesh/merge.h"
#include "mesh/read_binm.h"
#include "mesh/read_obj.h"
#include "mesh/read_ply.h"

namespace sherd {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLargestUnpacked = std::size_t{1}
                                         << 33;  // a small .gz may stand for any number of zeros

std::optional<MeshFormat> formatFromExtension(const std::string& extension) {
  constexpr std::array<std::pair<std::string_view, MeshFormat>, 7> kFormats{
      {{".obj", MeshFormat::obj},
       {".ply", MeshFormat::ply},
       {".stl", MeshFormat::stl},
       {".off", MeshFormat::off},
       {".gltf", MeshFormat::gltf},
       {".glb", MeshFormat::glb},
       {".binm", MeshFormat::binm}}};
  for (const auto& [name, format] : kFormats)
    if (lowerCase(extension) == name) return format;
  return std::nullopt;
}

// Unpack a gzip file, which may be several streams one after another.
std::string gunzip(const std::string& packed, const std::string& name) {
  const auto fail = [&](const std::string& what) {
    return Error(ErrorCode::input, name + ": " + what);
  };
  z_stream stream{};
  constexpr int kGzipOnly = 16 + MAX_WBITS;
  if (inflateInit2(&stream, kGzipOnly) != Z_OK)
    throw Error(ErrorCode::internal, "zlib does not start");
  const std::unique_ptr<z_stream, int (*)(z_stream*)> guard(&stream, inflateEnd);

  std::string out;
  std::vector<char> buffer(std::size_t{1} << 18);
  std::size_t taken = 0;
  int status = Z_OK;
  while (status != Z_STREAM_END || taken < packed.size()) {
    if (status == Z_STREAM_END && inflateReset(&stream) != Z_OK)
      throw fail("its gzip stream is damaged");
    const std::size_t give = std::min(packed.size() - taken, buffer.size());
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data() + taken));
    stream.avail_in = static_cast<uInt>(give);
    stream.next_out = reinterpret_cast<Bytef*>(buffer.data());
    stream.avail_out = static_cast<uInt>(buffer.size());
    status = inflate(&stream, Z_NO_FLUSH);
    taken += give - stream.avail_in;
    out.append(buffer.data(), buffer.size() - stream.avail_out);
    if (out.size() > kLargestUnpacked)
      throw fail("unpacks to more than 8 GiB, which is more than is read");
    if (status == Z_BUF_ERROR) throw fail("cut short: its gzip stream has no end");
    if (status != Z_OK && status != Z_STREAM_END) throw fail("its gzip stream is damaged");
  }
  return out;
}

// A file named bowl.STL.gz is a packed .stl whose stem is bowl.
struct FileName {
  fs::path stem;
  std::string extension;
  bool packed = false;
};

FileName splitName(const fs::path& file) {
  FileName name{file.filename(), "", lowerCase(file.extension().string()) == ".gz"};
  if (name.packed) name.stem = name.stem.stem();
  name.extension = name.stem.extension().string();
  name.stem = name.stem.stem();
  return name;
}

void requireFinite(const MeshFile& file, const RawMesh& raw) {
  for (std::size_t i = 0; i < raw.triangles.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      const glm::dvec3& v = raw.vertices[raw.triangles[i][k]];
      if (std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z)) continue;
      std::array<char, 100> place{};
      std::snprintf(place.data(), place.size(), "(%g, %g, %g)", v.x, v.y, v.z);
      throw inputError(file, "a corner of triangle " + std::to_string(i + 1) + " lies at " +
                                 place.data() + ", finite coordinates are needed");
    }
  }
}

RawMesh readWithLook(const MeshFile& file) {
  RawMesh raw = file.format == MeshFormat::ply ? readPlyWithLook(file) : readObjWithLook(file);
  for (glm::vec2& at : raw.texcoords) {
    if (!std::isfinite(at.x) || !std::isfinite(at.y)) at = glm::vec2(0.0f);
  }
  return raw;
}

}  // namespace

std::string readFileBytes(const fs::path& file) {
  const auto fail = [&](const std::string& what) {
    return Error(ErrorCode::input, file.string() + ": " + what);
  };
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  if (status.type() == fs::file_type::not_found) throw fail("there is no such file");
  if (error) throw fail("cannot be read: " + error.message());
  if (fs::is_directory(status)) throw fail("is a directory, a file is needed");
  if (!fs::is_regular_file(status)) throw fail("is not a regular file");
  std::ifstream in(file, std::ios::binary);
  if (!in) throw fail("cannot be opened for reading");
  std::string bytes(static_cast<std::size_t>(fs::file_size(file)), '\0');
  in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (static_cast<std::size_t>(in.gcount()) != bytes.size())
    throw fail("cannot be read to its end");
  return bytes;
}

bool isMeshName(const fs::path& file) {
  return formatFromExtension(splitName(file).extension).has_value();
}

SourceMesh readMesh(const fs::path& path) { return meshFromBytes(path, readFileBytes(path)); }

SourceMesh meshFromBytes(const fs::path& path, std::string bytes) {
  const FileName name = splitName(path);
  SourceMesh out;
  out.name = path.filename().string();
  out.stem = name.stem.string();
  const std::optional<MeshFormat> format = formatFromExtension(name.extension);
  if (!format) {
    throw Error(
        ErrorCode::input,
        out.name + ": the extension '" + name.extension +
            "' is not known; read are .obj .ply .stl .off .gltf .glb .binm, and each with .gz");
  }
  out.sha256 = sha256(bytes);
  MeshFile file{path, out.name, *format, name.packed ? gunzip(bytes, out.name) : std::move(bytes)};
  if (file.bytes.empty()) throw inputError(file, "the file is empty");

  const FileCounts counts = checkComplete(file);
  if (counts.polygons == 0u) throw inputError(file, "holds no triangle");
  RawMesh raw = file.format == MeshFormat::binm ? readBinm(file)
                : counts.look                   ? readWithLook(file)
                                                : readWithAssimp(file);
  if (counts.polygons && *counts.polygons != raw.polygons) {
    throw inputError(file, "holds " + std::to_string(*counts.polygons) + " faces, of which " +
                               std::to_string(raw.polygons) + " could be read");
  }
  requireFinite(file, raw);
  out.fileVertices = counts.vertices.value_or(raw.vertices.size());
  Merged merged = mergeVertices(raw);
  if (merged.mesh.triangles.empty())
    throw inputError(file, "holds no triangle with three different corners");
  out.mesh = std::move(merged.mesh);
  out.degenerateTriangles = merged.degenerateTriangles;
  out.appearance = std::move(raw.look);
  out.appearance.surface = std::move(merged.look);
  return out;
}

}  // namespace sherd
