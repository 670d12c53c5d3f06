// The surface of labeled voxels, one plane of them after another.
#include "formats/voxels/voxel_faces.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <utility>

#include "base/cancel_flag.h"

namespace sherd {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

// Yields the planes of a box in order, from runs that may span planes.
class Planes {
 public:
  explicit Planes(const RunLengthVoxels& voxels) : voxels_(voxels) {}

  // Returns [ny * nz], 1 where a voxel of the next plane has a label.
  std::vector<std::uint8_t> next() {
    std::vector<std::uint8_t> plane(static_cast<std::size_t>(voxels_.dims.y()) *
                                    static_cast<std::size_t>(voxels_.dims.z()));
    for (std::size_t at = 0; at < plane.size() && run_ < voxels_.runs.size();) {
      const Run& run = voxels_.runs[run_];
      const std::size_t count = std::min<std::size_t>(run.length - used_, plane.size() - at);
      std::fill_n(plane.begin() + static_cast<std::ptrdiff_t>(at), count,
                  static_cast<std::uint8_t>(run.label != 0));
      at += count;
      used_ += count;
      if (used_ == run.length) ++run_, used_ = 0;
    }
    return plane;
  }

 private:
  const RunLengthVoxels& voxels_;
  std::size_t run_ = 0;   // run of the next voxel
  std::size_t used_ = 0;  // its voxels that are done
};

// Corners of voxels are lattice points: (x, y, z) is the low corner of voxel (x, y, z). Vertex
// numbers are kept for two planes of points, which suffices for one plane of voxels.
class Faces {
 public:
  Faces(const openvdb::Coord& dims, const GridFrame& frame)
      : dims_(dims), frame_(frame), low_(points()), high_(points()) {}

  // Adds the faces between planes x - 1 and x of voxels, and those within plane x.
  void add(int x, const std::vector<std::uint8_t>& below, const std::vector<std::uint8_t>& plane) {
    for (int y = 0; y < dims_.y(); ++y) {
      for (int z = 0; z < dims_.z(); ++z) {
        const bool here = at(plane, y, z);
        if (at(below, y, z) != here) {
          face({{{x, y, z}, {x, y, z + 1}, {x, y + 1, z + 1}, {x, y + 1, z}}}, x, here);
        }
        if (!here) continue;
        const auto side = [&](int dy, int dz, std::array<openvdb::Coord, 4> corners) {
          if (!at(plane, y + dy, z + dz)) face(corners, x, true);
        };
        side(-1, 0, {{{x, y, z}, {x + 1, y, z}, {x + 1, y, z + 1}, {x, y, z + 1}}});
        side(1, 0, {{{x, y + 1, z}, {x, y + 1, z + 1}, {x + 1, y + 1, z + 1}, {x + 1, y + 1, z}}});
        side(0, -1, {{{x, y, z}, {x, y + 1, z}, {x + 1, y + 1, z}, {x + 1, y, z}}});
        side(0, 1, {{{x, y, z + 1}, {x + 1, y, z + 1}, {x + 1, y + 1, z + 1}, {x, y + 1, z + 1}}});
      }
    }
    std::swap(low_, high_);
    std::fill(high_.begin(), high_.end(), kNone);
  }

  std::size_t count() const { return mesh_.triangles.size(); }
  TriangleMesh take() { return std::move(mesh_); }

 private:
  std::vector<std::uint32_t> points() const {
    return std::vector<std::uint32_t>(
        static_cast<std::size_t>(dims_.y() + 1) * static_cast<std::size_t>(dims_.z() + 1), kNone);
  }
  bool at(const std::vector<std::uint8_t>& plane, int y, int z) const {
    if (y < 0 || z < 0 || y >= dims_.y() || z >= dims_.z()) return false;
    return plane[static_cast<std::size_t>(y) * static_cast<std::size_t>(dims_.z()) +
                 static_cast<std::size_t>(z)] != 0;
  }
  std::uint32_t vertex(const openvdb::Coord& point, int x) {
    std::uint32_t& number =
        (point.x() == x ? low_ : high_)[static_cast<std::size_t>(point.y()) *
                                            static_cast<std::size_t>(dims_.z() + 1) +
                                        static_cast<std::size_t>(point.z())];
    if (number == kNone) {
      number = static_cast<std::uint32_t>(mesh_.vertices.size());
      const glm::dvec3 corner(point.x(), point.y(), point.z());
      mesh_.vertices.push_back(frame_.worldFromIndex(corner - 0.5));
    }
    return number;
  }
  // Adds a face of plane x, its corners counter-clockwise seen from outside, or clockwise.
  void face(const std::array<openvdb::Coord, 4>& corners, int x, bool counterClockwise) {
    std::array<std::uint32_t, 4> v{};
    for (std::size_t i = 0; i < 4; ++i) v[i] = vertex(corners[i], x);
    if (!counterClockwise) std::swap(v[1], v[3]);
    mesh_.triangles.push_back({v[0], v[1], v[2]});
    mesh_.triangles.push_back({v[0], v[2], v[3]});
  }

  openvdb::Coord dims_;
  GridFrame frame_;
  std::vector<std::uint32_t> low_, high_;  // [(ny+1) * (nz+1)] vertices at x and x + 1, or kNone
  TriangleMesh mesh_;
};

}  // namespace

std::optional<TriangleMesh> voxelFaces(const RunLengthVoxels& voxels, const GridFrame& frame,
                                       std::size_t most, const Progress* progress) {
  Planes planes(voxels);
  Faces faces(voxels.dims, frame);
  std::vector<std::uint8_t> below(static_cast<std::size_t>(voxels.dims.y()) *
                                  static_cast<std::size_t>(voxels.dims.z()));
  const std::vector<std::uint8_t> empty = below;
  for (int x = 0; x <= voxels.dims.x(); ++x) {
    throwIfCancelled(progress);
    std::vector<std::uint8_t> plane = x < voxels.dims.x() ? planes.next() : empty;
    faces.add(x, below, plane);
    if (faces.count() > most) return std::nullopt;
    below = std::move(plane);
  }
  return faces.take();
}

}  // namespace sherd
