// Report of a mesh's defects and repairs.
#pragma once

#include <sherd/folder.h>

#include <cstddef>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

namespace sherd {

/// The largest relative difference of the solid's volume from the mesh's without a warning.
inline constexpr double kVolumesAgree = 0.03;

/// Returns meshReportJson() as JSON.
[[nodiscard]] nlohmann::ordered_json reportJson(const SourceMesh& source,
                                                const FractureResult& result);

/// Returns coordinatesJson() as JSON.
[[nodiscard]] nlohmann::ordered_json jsonOfCoordinates(const CoordinateSystem& coordinates);

/// Returns what Surface::exact made of the input's holes, and of bodies that overlap, touch or
/// cross themselves, as a clause; empty where there are none.
[[nodiscard]] std::string unitedText(const UnitedBodies& united);

/// Returns the names of the objects that some triangles are of; none where the file has one.
[[nodiscard]] std::vector<std::string> objectsOf(const SourceMesh& source,
                                                 std::span<const std::uint32_t> triangles);

/// Returns which fragments have smooth surfaces instead of exact ones, of which objects of the
/// file, and why, as a clause; empty if none has.
///   fragments  the number of all
///   failure    FractureResult::exactFailure
///   smooth     FractureResult::smooth
[[nodiscard]] std::string smoothText(const SourceMesh& source, std::size_t fragments,
                                     const std::string& failure,
                                     std::span<const SmoothBodies> smooth);

}  // namespace sherd
