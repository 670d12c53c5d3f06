// Reads a mesh file: bytes, unpacking, the format's reader, merging.
#include "formats/mesh_files/read_mesh.h"

#include <sherd/error.h>
#include <sherd/files.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <future>
#include <limits>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>

#include "base/files/file_bytes.h"
#include "base/files/sha256.h"
#include "base/finite.h"
#include "base/little_endian.h"
#include "base/text/lower_case.h"
#include "base/text/text_scan.h"
#include "base/threads.h"
#include "formats/gltf/read_gltf.h"
#include "formats/mesh/contradictions.h"
#include "formats/mesh/merge.h"
#include "formats/mesh/normals.h"
#include "formats/mesh_files/read_3mf.h"
#include "formats/mesh_files/read_assimp.h"
#include "formats/mesh_files/read_binm.h"
#include "formats/mesh_files/read_lines.h"
#include "formats/mesh_files/read_off.h"
#include "formats/mesh_files/read_stl.h"
#include "formats/obj/read_obj.h"
#include "formats/ply/read_ply.h"
#include "mesh/coordinate_system.h"

namespace sherd {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLargestUnpacked = std::size_t{1}
                                         << 33;  // a small .gz can unpack to any number of zeros

constexpr std::pair<std::string_view, MeshFormat> kFormats[] = {
    {".obj", MeshFormat::obj},     {".ply", MeshFormat::ply},   {".stl", MeshFormat::stl},
    {".off", MeshFormat::off},     {".gltf", MeshFormat::gltf}, {".glb", MeshFormat::glb},
    {".binm", MeshFormat::binm},   {".fbx", MeshFormat::fbx},   {".dae", MeshFormat::dae},
    {".3mf", MeshFormat::threeMf},
};

std::string extensions() {
  std::string all;
  for (const auto& [name, format] : kFormats) all.append(all.empty() ? "" : " ").append(name);
  return all;
}

std::optional<MeshFormat> formatFromExtension(const std::string& extension) {
  for (const auto& [name, format] : kFormats)
    if (lowerCase(extension) == name) return format;
  return std::nullopt;
}

// Returns whether a file of the format may begin with `bytes`; checks formats with a fixed
// beginning.
bool mayBegin(MeshFormat format, std::string_view bytes) {
  switch (format) {
    case MeshFormat::ply:
      return withoutByteOrderMark(bytes).starts_with("ply");
    case MeshFormat::glb:
      return bytes.starts_with("glTF");
    case MeshFormat::gltf:
      return trimmed(withoutByteOrderMark(bytes)).starts_with('{');
    default:
      return true;
  }
}

// Returns the length in the last four bytes of a gzip file; 0 if it is impossible.
std::size_t lastLength(std::string_view packed) {
  constexpr std::size_t kMostInflated = 1032;  // largest ratio of inflated to deflated bytes
  if (packed.size() < sizeof(std::uint32_t)) return 0;
  const std::size_t length = loadLittle<std::uint32_t>(packed.data() + packed.size() - 4);
  return length / kMostInflated <= packed.size() ? length : 0;
}

// Reserves room for more text, charged before it is allocated; capacity at least doubles.
void makeRoom(std::string& text, std::size_t more, MemoryBudget& memory) {
  const std::size_t before = text.capacity(), needed = text.size() + more;
  if (needed <= before) return;
  const std::size_t room = std::max(needed, 2 * before);
  memory.charge(room);
  text.reserve(room);
  memory.release(before);
}

// Unpacks a gzip file, which may be several streams, block by block. If the beginning cannot be of
// its format, only that is unpacked, and the reader refuses it.
std::string gunzip(const std::string& packed, const std::string& name, MeshFormat format,
                   MemoryBudget& memory, const Progress* progress) {
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
    throwIfCancelled(progress);
    if (status == Z_STREAM_END && inflateReset(&stream) != Z_OK)
      throw fail("its gzip stream is damaged");
    const std::size_t give = std::min(packed.size() - taken, buffer.size());
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data() + taken));
    stream.avail_in = static_cast<uInt>(give);
    stream.next_out = reinterpret_cast<Bytef*>(buffer.data());
    stream.avail_out = static_cast<uInt>(buffer.size());
    status = inflate(&stream, Z_NO_FLUSH);
    taken += give - stream.avail_in;
    const std::size_t got = buffer.size() - stream.avail_out;
    makeRoom(out, got, memory);
    out.append(buffer.data(), got);
    if (out.size() == got && got > 0) {  // the first block
      if (!mayBegin(format, out)) return out;
      // The file's end holds the length of its last stream, in 32 bits: for most files the size of
      // all.
      makeRoom(out, lastLength(packed) - std::min(lastLength(packed), got), memory);
    }
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

RawMesh readRaw(const MeshFile& file) {
  switch (file.format) {
    case MeshFormat::obj:
      return readObj(file);
    case MeshFormat::ply:
      return readPly(file);
    case MeshFormat::stl:
      return readStl(file);
    case MeshFormat::off:
      return readOff(file);
    case MeshFormat::gltf:
    case MeshFormat::glb:
      return readGltf(file);
    case MeshFormat::binm:
      return readBinm(file);
    case MeshFormat::threeMf:
      return read3mf(file);
    case MeshFormat::fbx:
    case MeshFormat::dae:
      return readByAssimp(file, assimpLimits(file.bytes.size(), file.memory->left()));
  }
  return {};
}

// What coordinates mean where a file does not say.  Programs for printing and machining use the
// first three; the definition of 3MF has z up.
struct FormatCoordinates {
  MeshFormat format;
  double metersPerUnit;
  char up;
};
constexpr FormatCoordinates kCoordinates[] = {
    {MeshFormat::stl, 0.001, 'z'}, {MeshFormat::off, 0.001, 'z'}, {MeshFormat::threeMf, 0.001, 'z'},
    {MeshFormat::obj, 1.0, 'y'},   {MeshFormat::ply, 1.0, 'y'},   {MeshFormat::gltf, 1.0, 'y'},
    {MeshFormat::glb, 1.0, 'y'},   {MeshFormat::binm, 1.0, 'y'},  {MeshFormat::fbx, 1.0, 'y'},
    {MeshFormat::dae, 1.0, 'y'}};

CoordinateSystem coordinatesOf(const RawMesh& raw, MeshFormat format) {
  CoordinateSystem coordinates;
  for (const FormatCoordinates& usual : kCoordinates) {
    if (usual.format != format) continue;
    coordinates.metersPerUnit = usual.metersPerUnit;
    coordinates.up = usual.up;
  }
  if (raw.metersPerUnit && isUnit(*raw.metersPerUnit)) {
    coordinates.metersPerUnit = exactUnit(*raw.metersPerUnit);
    coordinates.unitFrom = CoordinateBasis::file;
  }
  if (raw.up) {
    coordinates.up = *raw.up;
    coordinates.upFrom = CoordinateBasis::file;
  }
  return coordinates;
}

void checkMerged(const MeshFile& file, const SourceMesh& source) {
  if (source.mesh.triangles.empty() && source.droppedTriangles > 0) {
    const std::string which = source.droppedVertices == source.fileVertices ? "all " : "";
    throw inputError(file, which + std::to_string(source.droppedVertices) +
                               " vertices are not finite, and every triangle uses one; finite "
                               "coordinates are needed");
  }
  if (source.mesh.triangles.empty())
    throw inputError(file, "holds no triangle with three different corners");
  if (const auto length = tooLong(source.mesh)) throw inputError(file, *length);
}

//   bytes   may be moved from
//   memory  charged with them
MeshFile unpacked(const fs::path& path, std::string& bytes, MemoryBudget& memory,
                  const Progress* progress) {
  const FileName name = splitName(path);
  const std::string fileName = path.filename().string();
  const std::optional<MeshFormat> format = formatFromExtension(name.extension);
  if (!format) {
    throw Error(ErrorCode::input, fileName + ": the extension '" + name.extension +
                                      "' is not known; supported are " + extensions() +
                                      ", and each with .gz");
  }
  MeshFile file{
      path,    fileName,
      *format, name.packed ? gunzip(bytes, fileName, *format, memory, progress) : std::move(bytes),
      &memory, progress};
  if (file.bytes.empty()) throw inputError(file, "the file is empty");
  return file;
}

// Reads in the caller's thread, as `progress` requires.
RawMesh checkedRaw(const MeshFile& file) {
  RawMesh raw = readRaw(file);
  if (raw.triangles.empty()) throw inputError(file, "holds no triangle");
  if (raw.vertices.size() > std::numeric_limits<std::uint32_t>::max())
    throw inputError(file, "has more than 2^32 vertices, which is more than can be held");
  // Readers check what they read; what one of them missed must not be used as an index.
  if (const auto contradiction = contradictionIn(raw))
    throw inputError(file, "contradicts itself: " + *contradiction);
  return raw;
}

//   memory  charged with `bytes`
SourceMesh meshOf(const fs::path& path, std::string bytes, MemoryBudget& memory,
                  const Progress* progress) {
  const FileName name = splitName(path);
  const MeshFile file = unpacked(path, bytes, memory, progress);
  std::future<std::string> hash =
      startedTask([&] { return sha256(name.packed ? bytes : file.bytes); });
  RawMesh raw = checkedRaw(file);
  completeNormals(raw);
  const CoordinateSystem coordinates = coordinatesOf(raw, file.format);

  memory.charge(mergingMemory(raw));
  checkpoint(file);
  SourceMesh out = mergeVertices(std::move(raw), &memory);
  checkMerged(file, out);
  out.coordinates = coordinates;
  out.name = file.name;
  out.stem = name.stem.string();
  out.sha256 = hash.get();
  if (out.droppedVertices > 0) {
    out.warnings.push_back(out.name + ": " + std::to_string(out.droppedVertices) +
                           " vertices are not finite; the " + std::to_string(out.droppedTriangles) +
                           " triangles that use them are dropped");
  }
  return out;
}

}  // namespace

std::string readFileBytes(const fs::path& file, MemoryBudget* memory) {
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
  const std::uintmax_t size = fs::file_size(file);
  if (memory != nullptr) memory->charge(size);
  std::string bytes(static_cast<std::size_t>(size), '\0');
  in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (static_cast<std::size_t>(in.gcount()) != bytes.size())
    throw fail("cannot be read to its end");
  return bytes;
}

bool isMeshName(const fs::path& file) {
  return formatFromExtension(splitName(file).extension).has_value();
}

SourceMesh readMesh(const fs::path& path, const ReadOptions& options, const Progress* progress) {
  MemoryBudget memory(path.filename().string(), options.maxMemory);
  std::string bytes = readFileBytes(path, &memory);
  return meshOf(path, std::move(bytes), memory, progress);
}

ValuedMesh readValuedMesh(const fs::path& path, const std::string& name, const ReadOptions& options,
                          const Progress* progress) {
  MemoryBudget memory(path.filename().string(), options.maxMemory);
  std::string bytes = readFileBytes(path, &memory);
  MeshFile file = unpacked(path, bytes, memory, progress);
  file.attribute = name;
  RawMesh raw = checkedRaw(file);
  if (raw.values.size() != raw.vertices.size()) {
    std::string known;
    for (const std::string& other : raw.valueNames) {
      known += (known.empty() ? "" : ", ") + inQuotes(other);
    }
    throw inputError(file,
                     "its vertices have no attribute " + inQuotes(name) +
                         (known.empty() ? ", nor another one that is read" : ", but " + known));
  }
  std::erase_if(raw.triangles, [&](const glm::uvec3& t) {
    return !(isFinite(raw.vertices[t.x]) && isFinite(raw.vertices[t.y]) &&
             isFinite(raw.vertices[t.z]));
  });
  if (raw.triangles.empty()) throw inputError(file, "holds no triangle with finite corners");
  return {{std::move(raw.vertices), std::move(raw.triangles)}, std::move(raw.values)};
}

Guide guideFromBytes(const fs::path& path, std::string bytes, const ReadOptions& options,
                     const Progress* progress) {
  MemoryBudget memory(path.filename().string(), options.maxMemory);
  memory.charge(bytes.size());
  const MeshFile file = unpacked(path, bytes, memory, progress);
  Guide guide{.file = path.string()};
  guide.sha256 = sha256(splitName(path).packed ? bytes : file.bytes);
  bool hasFaces = true;
  if (file.format == MeshFormat::obj || file.format == MeshFormat::ply) {
    FileLines lines = file.format == MeshFormat::obj ? readObjLines(file) : readPlyLines(file);
    hasFaces = lines.hasFaces;
    guide.polylines = std::move(lines.polylines);
    if (!hasFaces && guide.polylines.empty())
      throw inputError(file, "holds neither lines nor faces");
  }
  if (!hasFaces) return guide;
  RawMesh raw = checkedRaw(file);
  memory.charge(mergingMemory(raw));
  SourceMesh merged = mergeVertices(std::move(raw), &memory);
  checkMerged(file, merged);
  guide.mesh = {std::move(merged.mesh.vertices), std::move(merged.mesh.triangles)};
  return guide;
}

Guide readGuide(const fs::path& path, const ReadOptions& options, const Progress* progress) {
  return guideFromBytes(path, readFileBytes(path), options, progress);
}

SourceMesh meshFromBytes(const fs::path& path, std::string bytes, const ReadOptions& options,
                         const Progress* progress) {
  MemoryBudget memory(path.filename().string(), options.maxMemory);
  memory.charge(bytes.size());
  return meshOf(path, std::move(bytes), memory, progress);
}

}  // namespace sherd
