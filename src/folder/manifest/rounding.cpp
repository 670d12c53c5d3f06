// What single precision loses far from the origin.
#include "folder/manifest/rounding.h"

#include <algorithm>

#include "base/text/formatted.h"
#include "base/text/option_text.h"
#include "formats/mesh_files/write_mesh.h"
#include "mesh/single_rounding.h"

namespace sherd {
namespace {

const char* extensionOf(MeshFileFormat format) {
  switch (format) {
    case MeshFileFormat::ply:
      return ".ply";
    case MeshFileFormat::obj:
      return ".obj";
    case MeshFileFormat::glb:
      return ".glb";
    case MeshFileFormat::stl:
    case MeshFileFormat::stlText:
      return ".stl";
    case MeshFileFormat::binm:
      return ".binm";
  }
  return "";
}

bool isBeyond(double length, const Solid& solid) {
  return length > kMostRoundingVoxels * solid.frame.voxelSize;
}

}  // namespace

bool hasFloatFormat(const WriteOptions& write) {
  return write.mesh &&
         !std::all_of(write.meshFormats.begin(), write.meshFormats.end(), holdsDoubles);
}

double singleRounding(const Solid& solid) {
  return singleRounding(
      {solid.frame.worldFromIndex(solid.box.min), solid.frame.worldFromIndex(solid.box.max)});
}

bool isDouble(const WriteOptions& write, bool isExact, const Solid& solid) {
  return write.precision == Precision::full ||
         (write.precision == Precision::automatic &&
          (isExact || isBeyond(singleRounding(solid), solid)));
}

Rounding roundingOf(const WriteOptions& write, const Solid& solid) {
  Rounding rounding{{}, singleRounding(solid)};
  if (!isBeyond(rounding.length, solid)) return rounding;
  const bool hasDoubles = write.precision != Precision::single;  // it is beyond
  for (std::size_t i = 0; i < write.meshFormats.size() && write.mesh; ++i) {
    if (hasDoubles && holdsDoubles(write.meshFormats[i])) continue;
    rounding.files.emplace_back(extensionOf(write.meshFormats[i]));
  }
  if (!hasDoubles && write.proxy) rounding.files.emplace_back("proxies");
  if (!hasDoubles && write.boundaries) rounding.files.emplace_back("boundaries.obj");
  if (write.houdini) rounding.files.emplace_back("pieces.geo");
  if (write.houdini || write.graph) rounding.files.emplace_back("graph.geo");
  if (write.points.count > 0) rounding.files.emplace_back("points");
  if (write.distances.count > 0) rounding.files.emplace_back("sdf");
  if (write.correspondences > 0) rounding.files.emplace_back("correspondences.npz");
  return rounding;
}

std::string roundingWarning(const WriteOptions& write, const Solid& solid) {
  const Rounding rounding = roundingOf(write, solid);
  if (rounding.files.empty()) return {};
  std::string sentence = formatted(
                             "so far from the origin single precision moves points by up to %.2g "
                             "units, %.2g voxels, in ",
                             rounding.length, rounding.length / solid.frame.voxelSize) +
                         joinedText(rounding.files, ", ") +
                         "; the option recenter moves the object to the origin";
  if (hasFloatFormat(write)) {
    sentence += ", and .ply and .obj hold double precision";
  } else if (write.precision == Precision::single &&
             (write.mesh || write.proxy || write.boundaries)) {
    sentence += ", and the option precision may be auto or double";
  }
  return sentence;
}

}  // namespace sherd
