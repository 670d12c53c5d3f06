// What the page of the viewer shows.
#pragma once

#include <sherd/mesh.h>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace sherd {

/// A fragment in the viewer.  Its mesh belongs to the caller.
struct ViewerPiece {
  struct Contact {
    int fragment = 0;  ///< id of the other fragment
    double area = 0.0;
  };

  int id = 0;
  bool isMissing = false;                         ///< withheld: a ghost
  const TriangleMesh* mesh = nullptr;             ///< null: its shape is not known
  const SurfaceAttributes* attributes = nullptr;  ///< of the mesh; null: none

  // As in the manifest; not finite, or 0 of counts, where not known.
  std::uint64_t voxels = 0;
  double volume = 0.0;
  double share = 0.0;
  double area = 0.0;
  double fractureArea = 0.0;
  glm::dvec3 centroid{0.0};
  std::array<double, 6> inertia{};  ///< xx, yy, zz, xy, xz, yz about the centroid, unit density
  std::vector<Contact> contacts;
  int split = 0;  ///< that it comes from, 1..splits; 0: none
};

/// A fracture in the viewer.
struct ViewerScene {
  struct Material {
    glm::u8vec3 color{255};  ///< sRGB
    int texture = -1;        ///< an index into textures; -1: none
    bool isInside = false;   ///< of fracture surfaces
  };

  std::string title;  ///< untrusted, not necessarily UTF-8
  std::string unit;   ///< of length; empty: not known
  char up = 'y';
  double density = 1.0;  ///< kilograms per cubic unit; 1: masses are not shown
  std::vector<ViewerPiece> pieces;
  std::vector<int> splitParents;    ///< as FragmentSet::splitParents
  std::vector<Material> materials;  ///< to which attributes refer; empty: none
  std::vector<Texture> textures;
};

}  // namespace sherd
