// Edge collapses that can be undone.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "remesh/complex.h"

namespace sherd {

/// The faces that edge collapses changed, as they were.
class CollapseLog {
 public:
  explicit CollapseLog(std::size_t faces) : last_(faces, kNone) {}

  /// Records a collapse that is about to change some faces.
  void add(std::span<const std::uint32_t> changed, std::span<const ComplexFace> faces);

  /// Returns whether a face is changed by a collapse that is not undone.
  [[nodiscard]] bool isChanged(std::uint32_t face) const { return last_[face] != kNone; }

  /// Returns the collapses that undo() undoes, the latest first.
  [[nodiscard]] std::vector<std::uint32_t> collapsesToUndo(std::span<const std::uint32_t> of,
                                                           std::size_t depth) const;

  /// Undoes the last collapses that changed each of some faces, and all after them that changed a
  /// face which one of these did.
  ///   depth   how many of each face
  ///   faces   restored
  ///   return  the restored faces, ascending
  std::vector<std::uint32_t> undo(std::span<const std::uint32_t> of, std::size_t depth,
                                  std::vector<ComplexFace>& faces);

 private:
  static constexpr std::uint32_t kNone = 0xffffffffu;

  struct Change {
    std::uint32_t collapse = 0, face = 0;
    std::uint32_t before = kNone;  // the face's change before this one
    glm::uvec3 corner{0};
  };

  std::vector<Change> changes_;  // by collapse
  [[nodiscard]] std::span<const Change> changesOf(std::uint32_t collapse) const;

  std::vector<std::uint32_t> first_;  // [collapses] into changes_
  std::vector<std::uint32_t> last_;   // [faces] the last change, or kNone
};

}  // namespace sherd
