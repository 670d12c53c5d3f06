// Where a piece touches itself.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "clean/change.h"

namespace sherd {

/// One of the fans of a piece around a vertex, which is to get a vertex of its own.
struct SheetParting {
  std::vector<std::uint32_t> fan;  ///< faces of the piece, one after the other
  std::vector<std::uint32_t>
      behind;  ///< [fan] the faces of other pieces that these are the same as
};

/// Returns the fans of a piece around a vertex, the smallest first.  At an edge of four faces those
/// follow one another that have the inside between them.
///   return  empty where the piece does not touch itself there, where a fan has a face that is not
///           of a crack between two pieces, or where its faces do not follow from what is beyond
[[nodiscard]] std::vector<SheetParting> partings(const Stars& stars, std::uint16_t piece,
                                                 std::uint32_t vertex);

/// Returns the change by which the faces of a fan get another vertex.  What is beyond them meets in
/// the gap: a triangle for each edge of the fan at which that changes.
///   fresh     a new vertex
///   position  of it
[[nodiscard]] Change part(const Stars& stars, const SheetParting& parting, std::uint32_t vertex,
                          std::uint32_t fresh, const glm::dvec3& position, double distance);

/// Returns whether a parting leaves no piece with more than two faces at an edge, or more fans.
[[nodiscard]] bool partsSheets(const Stars& stars, const Change& change, std::uint32_t vertex,
                               std::uint16_t piece);

}  // namespace sherd
