// A mesh that a reader found, as bytes between two programs of one build.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "formats/mesh/mesh_reader.h"

namespace sherd {

[[nodiscard]] std::string streamOf(const RawMesh& mesh);

/// The mesh of a stream, whoever wrote it.
///   memory   charged with what names and materials take beyond their bytes in the stream; none:
///            nothing is charged
///   returns  none unless the stream is whole and what it holds is as RawMesh promises
///   throws   Error(input) they take more than may be used
[[nodiscard]] std::optional<RawMesh> meshFromStream(std::string_view stream,
                                                    MemoryBudget* memory = nullptr);

}  // namespace sherd
