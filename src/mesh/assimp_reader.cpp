// Reads a mesh by Assimp.  Only this and assimp_look.cpp include Assimp.
#include "mesh/assimp_reader.h"

#include <assimp/MemoryIOWrapper.h>
#include <assimp/scene.h>

#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>
#include <cstring>
#include <exception>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <memory>
#include <new>
#include <optional>
#include <string_view>

#include "mesh/assimp_look.h"
#include "mesh/gltf_buffer.h"
#include "mesh/text_scan.h"
#include "mesh/triangulate.h"

namespace sherd {
namespace {

// Assimp chooses the reader by the extension.
const char* assimpName(MeshFormat format) {
  switch (format) {
    case MeshFormat::obj:
      return "mesh.obj";
    case MeshFormat::ply:
      return "mesh.ply";
    case MeshFormat::stl:
      return "mesh.stl";
    case MeshFormat::off:
      return "mesh.off";
    case MeshFormat::gltf:
      return "mesh.gltf";
    case MeshFormat::glb:
      return "mesh.glb";
    case MeshFormat::binm:
      break;  // not Assimp's
  }
  return "";
}

// An OFF file as Assimp 5.2.5 can read it: without comments and blank lines, and with a number of
// edges.
std::string plainOff(const std::string& bytes) {
  LineReader lines(bytes);
  std::string_view line;
  nextDataLine(lines, line);
  std::string out(takeWord(line));
  if (isBlank(line)) nextDataLine(lines, line);  // else the counts stand beside the keyword
  const std::string_view vertices = takeWord(line), faces = takeWord(line);
  out.append("\n").append(vertices).append(" ").append(faces).append(" 0\n");
  while (nextDataLine(lines, line)) out.append(line).append("\n");
  return out;
}

// A binary PLY as Assimp 5.2.5 can read it, where it cannot; else empty.  Assimp takes a line feed
// before the first value for the second half of "\r\n" even where the header's lines end in "\n"
// (https://github.com/assimp/assimp/issues/5341), so it gets one more to take.
std::string plainPly(const std::string& bytes) {
  LineReader lines(bytes);
  bool binary = false;
  while (lines.next()) {
    std::string_view rest = lines.line();
    const std::string_view keyword = takeWord(rest);
    if (keyword == "format") binary = takeWord(rest) != "ascii";
    if (keyword == "end_header") break;
  }
  const std::size_t body = lines.position();
  const bool taken = binary && body < bytes.size() && bytes[body] == '\n' &&
                     std::string_view(bytes).substr(body - 2, 2) != "\r\n";
  return taken ? std::string(bytes).insert(body, 1, '\n') : std::string();
}

// A buffer that keeps its own bytes.
class OwnedStream : public Assimp::IOStream {
 public:
  explicit OwnedStream(std::string bytes)
      : bytes_(std::move(bytes)),
        view_(reinterpret_cast<const std::uint8_t*>(bytes_.data()), bytes_.size()) {}
  size_t Read(void* to, size_t size, size_t count) override { return view_.Read(to, size, count); }
  size_t Write(const void*, size_t, size_t) override { return 0; }
  aiReturn Seek(size_t offset, aiOrigin origin) override { return view_.Seek(offset, origin); }
  size_t Tell() const override { return view_.Tell(); }
  size_t FileSize() const override { return view_.FileSize(); }
  void Flush() override {}

 private:
  std::string bytes_;
  Assimp::MemoryIOStream view_;
};

// Shows Assimp the file in memory, and the buffers of a glTF file beside it; nothing else.
class MeshFiles : public Assimp::IOSystem {
 public:
  explicit MeshFiles(const MeshFile& file) : file_(file), name_(assimpName(file.format)) {
    if (file.format == MeshFormat::off) rewritten_ = plainOff(file.bytes);
    if (file.format == MeshFormat::ply) rewritten_ = plainPly(file.bytes);
  }

  bool Exists(const char* name) const override { return name == name_; }
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char* name, const char* mode) override {
    if (std::strchr(mode, 'w') != nullptr) return nullptr;
    if (name == name_) {
      const std::string& bytes = rewritten_.empty() ? file_.bytes : rewritten_;
      return new Assimp::MemoryIOStream(reinterpret_cast<const std::uint8_t*>(bytes.data()),
                                        bytes.size());
    }
    if (file_.format != MeshFormat::gltf && file_.format != MeshFormat::glb) return nullptr;
    // Assimp would take an exception for its own; it reports "could not open" with the name.
    try {
      return new OwnedStream(readGltfBuffer(file_, name));
    } catch (const Error&) {
      return nullptr;
    }
  }
  void Close(Assimp::IOStream* stream) override { delete stream; }

 private:
  const MeshFile& file_;
  std::string_view name_;
  std::string rewritten_;  // what Assimp sees in place of the file; empty: the file itself
};

// world = linear * local + offset.
struct Affine {
  glm::dmat3 linear{1.0};
  glm::dvec3 offset{0.0};
};

Affine compose(const Affine& outer, const aiMatrix4x4& m) {
  const glm::dmat3 linear(m.a1, m.b1, m.c1, m.a2, m.b2, m.c2, m.a3, m.b3,
                          m.c3);  // column by column
  return {outer.linear * linear, outer.linear * glm::dvec3(m.a4, m.b4, m.c4) + outer.offset};
}

void appendMesh(const MeshFile& file, const aiMesh& mesh, const Affine& world,
                const AssimpLook* look, RawMesh& out) {
  const std::size_t first = out.vertices.size();
  if (first + mesh.mNumVertices > std::numeric_limits<std::uint32_t>::max())
    throw inputError(file, "more than 2^32 vertices, which is more than can be held");
  // Left alone without need: 0 * inf would make one infinite coordinate three that are no numbers.
  const bool moved = world.linear != glm::dmat3(1.0) || world.offset != glm::dvec3(0.0);
  for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
    const aiVector3D& v = mesh.mVertices[i];
    const glm::dvec3 local(v.x, v.y, v.z);
    out.vertices.push_back(moved ? world.linear * local + world.offset : local);
  }
  const bool mirrored = glm::determinant(world.linear) < 0.0;
  std::vector<std::uint32_t> polygon;
  for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
    const aiFace& face = mesh.mFaces[i];
    if (face.mNumIndices < 3) continue;  // points and lines
    polygon.clear();
    for (unsigned k = 0; k < face.mNumIndices; ++k) {
      const unsigned corner = face.mIndices[mirrored ? face.mNumIndices - 1 - k : k];
      if (corner >= mesh.mNumVertices) {
        throw inputError(file, "face uses vertex " + std::to_string(corner) + ", its mesh has " +
                                   std::to_string(mesh.mNumVertices));
      }
      polygon.push_back(static_cast<std::uint32_t>(first + corner));
    }
    triangulate(out.vertices, polygon, out.triangles);
    ++out.polygons;
  }
  if (look != nullptr) appendLook(mesh, *look, out);
}

// Assimp takes it for a fault of the file.
void rethrowIfNoMemory(const std::exception_ptr& caught) {
  try {
    if (caught) std::rethrow_exception(caught);
  } catch (const std::bad_alloc&) {
    throw;
  } catch (...) {
  }
}

}  // namespace

RawMesh readWithAssimp(const MeshFile& file) {
  Assimp::Importer importer;
  importer.SetIOHandler(new MeshFiles(file));  // the importer deletes it
  // No post-processing: merging and triangulating are ours, and Assimp's are slow or leave holes.
  const aiScene* scene = importer.ReadFile(assimpName(file.format), 0);
  if (scene == nullptr || scene->mRootNode == nullptr) {
    rethrowIfNoMemory(importer.GetException());
    const std::string reason(importer.GetErrorString(), 0, 160);  // it may quote half of the file
    throw inputError(file, "cannot be read (Assimp: " + plainText(reason) + ")");
  }

  RawMesh out;
  std::optional<AssimpLook> look;  // of the other formats only their plain files come here
  if (file.format == MeshFormat::gltf || file.format == MeshFormat::glb) {
    look = lookOf(file, *scene, out.look);
  }
  struct Visit {
    const aiNode* node;
    Affine parent;
  };
  std::vector<Visit> stack{{scene->mRootNode, {}}};
  while (!stack.empty()) {
    const Visit visit = stack.back();
    stack.pop_back();
    const Affine world = compose(visit.parent, visit.node->mTransformation);
    for (unsigned i = 0; i < visit.node->mNumMeshes; ++i)
      appendMesh(file, *scene->mMeshes[visit.node->mMeshes[i]], world, look ? &*look : nullptr,
                 out);
    for (unsigned i = visit.node->mNumChildren; i-- > 0;)
      stack.push_back({visit.node->mChildren[i], world});
  }
  return out;
}

}  // namespace sherd
