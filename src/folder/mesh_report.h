// What was found wrong with a mesh and done about it, told.
#pragma once

#include <sherd/fracture.h>
#include <sherd/mesh.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace sherd {

/// A mesh whose volume and whose solid's differ by a larger share is worth a warning.
inline constexpr double kVolumesAgree = 0.03;

/// A file's name, and where one of its objects alone is meant, that object's.
[[nodiscard]] std::string titled(const std::string& file, const SourceMesh& source);

/// As manifests and `--json` have it.
[[nodiscard]] nlohmann::ordered_json reportJson(const SourceMesh& source,
                                                const FractureResult& result);

/// The same as lines for people.
[[nodiscard]] std::string reportText(const SourceMesh& source, const FractureResult& result);

/// What of it a user has to know: a sentence each.
[[nodiscard]] std::vector<std::string> reportWarnings(const SourceMesh& source,
                                                      const FractureResult& result);

}  // namespace sherd
