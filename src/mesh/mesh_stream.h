// A mesh that a reader found, as bytes between two programs of one build.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "mesh/mesh_reader.h"

namespace sherd {

[[nodiscard]] std::string streamOf(const RawMesh& mesh);

/// The mesh of a stream, whoever wrote it.
///   returns  none unless the stream is whole and what it holds is as RawMesh promises
[[nodiscard]] std::optional<RawMesh> meshFromStream(std::string_view stream);

}  // namespace sherd
