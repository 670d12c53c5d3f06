// The journal line of a fracture.
#pragma once

#include <sherd/dataset.h>

#include <glm/vec3.hpp>
#include <optional>

#include "dataset/journal/journal.h"
#include "folder/manifest/manifest.h"

namespace sherd {

/// The name of the intact object among an object's fractures.
inline constexpr const char* kWholeName = "whole";

/// A frame of positions: (p - center) * scale.
struct UnitBox {
  glm::dvec3 center{0.0};
  double scale = 1.0;

  [[nodiscard]] glm::dvec3 of(const glm::dvec3& p) const { return (p - center) * scale; }
};

/// The line of a fracture without its "files" and "archive".
class FractureLine {
 public:
  FractureLine(const std::string& name, const PlannedFracture& planned, std::uint64_t seed,
               int attempt, const DrawnValues& drawn);

  ///   result  in world space, not moved into a unit box
  ///   names   file names; `files` maps them to stored names
  ///   poses   the frame of the positions in the files, to add a random pose per fragment
  void addFragments(const FractureResult& result, const FractureFiles& names,
                    const StagedFiles& files, const std::optional<UnitBox>& poses);

  /// Records what positions lack to be the input's, of an object that was recentered.
  void setOffset(const std::optional<glm::dvec3>& offset);

  /// Records the objects of an assemblage: for each `mesh`, its key in the library, and more.
  void setObjects(Json objects);

  [[nodiscard]] const Json& json() const { return line_; }

 private:
  std::uint64_t seed_;
  Json line_;
};

}  // namespace sherd
