// A reader's result as bytes that two programs of one build exchange.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "formats/mesh/mesh_reader.h"

namespace sherd {

[[nodiscard]] std::string streamOf(const RawMesh& mesh);

/// Returns the mesh of a stream, which need not be trusted.
///   memory   charged with what names and materials take beyond their bytes in the stream; null:
///            nothing is charged
///   returns  nothing if the stream is incomplete or violates RawMesh's invariants
///   throws   Error(input) they take more than allowed
[[nodiscard]] std::optional<RawMesh> meshFromStream(std::string_view stream,
                                                    MemoryBudget* memory = nullptr);

}  // namespace sherd
