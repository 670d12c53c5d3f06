// The bodies of an input mesh that fragments with exact surfaces come from.
#pragma once

#include <sherd/fracture.h>

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace sherd {

/// The bodies of an input mesh of several: see bodiesOf.
struct InputBodies {
  std::size_t count = 0;                    ///< 0 if the input has one, or surfaces are not exact
  std::size_t united = 0;                   ///< bodies that are left of those that overlap or touch
  std::vector<std::uint32_t> ofTriangle{};  ///< [triangles of the input] kNone of those left out

  std::map<int, std::vector<std::uint32_t>> ofSmooth{};  ///< by id of a fragment with a smooth
                                                         ///< surface beside exact ones: the bodies
                                                         ///< that it may be of, ascending

  static constexpr std::uint32_t kNone = 0xffffffffu;

  /// Returns the bodies of which a fragment's mesh has triangles, ascending.
  [[nodiscard]] std::vector<std::uint32_t> of(const TriangleMesh& mesh) const;

  /// Returns [count] the names of the objects of the input of which a body has triangles, in the
  /// order of these objects; empty if the input has fewer than two.
  [[nodiscard]] std::vector<std::vector<std::string>> objects(const SourceMesh& source) const;
};

/// Returns the bodies of a fracture's input, numbered by their first triangles.
///   result  whose exact surfaces are made, or have failed
[[nodiscard]] InputBodies inputBodies(const FractureResult& result, const FractureOptions& options);

}  // namespace sherd
