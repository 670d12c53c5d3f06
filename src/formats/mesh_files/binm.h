// Writes .binm.
#pragma once

#include <sherd/files.h>
#include <sherd/mesh.h>

#include <string>

#include "formats/mesh/piece_mesh.h"

namespace sherd {

/// Writes the paper's `.binm`: positions and faces only.
///   throws  Error(output)
void writePieceBinm(const OutputFile& file, const PieceMesh& piece);

}  // namespace sherd
