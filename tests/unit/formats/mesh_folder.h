// A folder of mesh files that a test writes itself, read or refused.
#pragma once

#include <gtest/gtest.h>
#include <sherd/error.h>
#include <sherd/files.h>
#include <sherd/mesh.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "temp_folder.h"

namespace sherd {

class MeshFolder : public TempFolder {
 protected:
  std::filesystem::path write(const std::string& name, const std::string& bytes) const {
    std::filesystem::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    return folder_ / name;
  }
  SourceMesh read(const std::string& name, const std::string& bytes) const {
    return readMesh(write(name, bytes));
  }

  // The sentence a file is refused with; fails when it is read.
  std::string refusal(const std::filesystem::path& file) const {
    try {
      (void)readMesh(file);
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::input);
      const std::string sentence = e.what();
      EXPECT_EQ(sentence.find('\n'), std::string::npos);
      return sentence;
    }
    ADD_FAILURE() << file << " was read";
    return "";
  }
  std::string refusal(const std::string& name, const std::string& bytes) const {
    return refusal(write(name, bytes));
  }

  // Every beginning of a file is refused or, where only its end's blanks are missing, read whole.
  void expectEveryPrefixRefusedOrWhole(const std::string& name, const std::string& bytes,
                                       const TriangleMesh& whole,
                                       std::size_t blanksAtEnd = 0) const {
    for (std::size_t length = 0; length < bytes.size(); ++length) {
      const std::filesystem::path file = write(name, bytes.substr(0, length));
      if (length < bytes.size() - blanksAtEnd) {
        EXPECT_NE(refusal(file), "") << length;
      } else {
        EXPECT_EQ(readMesh(file).mesh.triangles.size(), whole.triangles.size()) << length;
      }
    }
  }
};

// The same triangles in space: vertices may be numbered and triangles ordered in any way.
inline void expectSameSurface(const TriangleMesh& a, const TriangleMesh& b) {
  const auto corners = [](const TriangleMesh& mesh) {
    using Corner = std::array<double, 3>;
    std::vector<std::array<Corner, 3>> out;
    for (const glm::uvec3& t : mesh.triangles) {
      std::array<Corner, 3> triangle;
      for (int i = 0; i < 3; ++i) {
        const glm::dvec3& v = mesh.vertices[t[i]];
        triangle[static_cast<std::size_t>(i)] = {v.x, v.y, v.z};
      }
      std::rotate(triangle.begin(), std::min_element(triangle.begin(), triangle.end()),
                  triangle.end());
      out.push_back(triangle);
    }
    std::sort(out.begin(), out.end());
    return out;
  };
  EXPECT_EQ(corners(a), corners(b));
  EXPECT_EQ(a.vertices.size(), b.vertices.size());
}

// The tetrahedron with corners 0, x, y, z: small, and exact in any format.
inline TriangleMesh tetrahedron() {
  return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
          {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
}

// Numbers as bytes, for writers.
inline void put(std::string& out, const void* value, std::size_t size, bool bigEndian = false) {
  std::string bytes(static_cast<const char*>(value), size);
  if (bigEndian) std::reverse(bytes.begin(), bytes.end());
  out += bytes;
}
template <class T>
void put(std::string& out, T value, bool bigEndian = false) {
  put(out, &value, sizeof value, bigEndian);
}

inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

}  // namespace sherd
