// viewer.html of a fracture that is being written.
#pragma once

#include <sherd/files.h>
#include <sherd/fracture.h>

#include <span>
#include <string>
#include <vector>

#include "folder/files/fracture_writer.h"
#include "viewer/scene.h"

namespace sherd {

/// Writes the page of the viewer, with fragments that are withheld as ghosts.
///   attributes  [fragments that are not withheld] of their meshes
///   maxBytes    as ViewerOptions::maxBytes
///   return      sentences about what it leaves out, with the file's name
///   throws      Error(output); Error(cancelled)
std::vector<std::string> writeViewer(const OutputFile& file, const FractureWriter& writer,
                                     const FractureResult& result,
                                     std::span<const SurfaceAttributes> attributes,
                                     std::uint64_t maxBytes, const Progress* progress);

/// Sets the unit, the upward axis and the density of a scene.
///   density  kilograms per cubic meter; 1: not given
void setCoordinates(ViewerScene& scene, const CoordinateSystem& coordinates, double density);

}  // namespace sherd
