// Report of a mesh's defects and repairs.
#pragma once

#include <sherd/fracture.h>
#include <sherd/mesh.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace sherd {

/// The largest relative difference of the solid's volume from the mesh's without a warning.
inline constexpr double kVolumesAgree = 0.03;

/// Returns a file's name, with the object's name if `source` is one object of the file.
[[nodiscard]] std::string titled(const std::string& file, const SourceMesh& source);

/// Returns the report for manifests and `--json`.
[[nodiscard]] nlohmann::ordered_json reportJson(const SourceMesh& source,
                                                const FractureResult& result);

/// Returns the report as lines of text.
[[nodiscard]] std::string reportText(const SourceMesh& source, const FractureResult& result);

/// Returns the warnings of the report, one sentence each.
[[nodiscard]] std::vector<std::string> reportWarnings(const SourceMesh& source,
                                                      const FractureResult& result);

}  // namespace sherd
