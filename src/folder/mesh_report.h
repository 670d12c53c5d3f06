// Report of a mesh's defects and repairs.
#pragma once

#include <sherd/folder.h>

#include <nlohmann/json.hpp>
#include <string>

namespace sherd {

/// The largest relative difference of the solid's volume from the mesh's without a warning.
inline constexpr double kVolumesAgree = 0.03;

/// Returns meshReportJson() as JSON.
[[nodiscard]] nlohmann::ordered_json reportJson(const SourceMesh& source,
                                                const FractureResult& result);

/// Returns what Surface::exact made of the input's holes, and of bodies that overlap, touch or
/// cross themselves, as a clause; empty where there are none.
[[nodiscard]] std::string unitedText(const UnitedBodies& united);

}  // namespace sherd
