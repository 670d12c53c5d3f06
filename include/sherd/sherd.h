// Sherd breaks 3D models.  This header includes the whole library.
#pragma once

/// @mainpage Sherd
///
/// A mesh in a file becomes a folder of fragments:
///
/// @code
/// sherd::provideKernelCache();                              // once, before the first device
/// sherd::Device device;                                     // the CPU, without a driver
/// const sherd::SourceMesh source = sherd::readMesh("bowl.obj");
/// sherd::WrittenFracture broken =
///     sherd::fractureInto("pieces", {source}, {.pieces = 8, .seed = 7}, device);
/// @endcode
///
/// The stages one by one, each a function from values to a new value:
///
/// @code
/// using namespace sherd;
/// PreparedSolid ready = prepared(voxelize(source.mesh, {.resolution = 128}), device);
/// std::vector<std::vector<Seed>> seeds{placeSeeds(ready.solid, ready.components, {.pieces = 8})};
/// Labels labels = grow(ready.solid.blocks, seeds, device).front();
/// Erosion eroded = erode(labels, {.iterations = 1}, device);
/// std::vector<Fragment> fragments = extractFragments(
///     ready.solid, extendLabels(eroded.labels, device), {.uneroded = &labels});
/// for (const Fragment& fragment : fragments) {
///   writePly(std::to_string(fragment.id) + ".ply", fragment.mesh);
/// }
/// @endcode
///
/// Every function that fails throws sherd::Error.  docs/api.md lists the headers, the conventions
/// that they share, and what may change between versions; examples/ has whole programs.

#include <sherd/coords.h>
#include <sherd/dataset.h>
#include <sherd/device.h>
#include <sherd/error.h>
#include <sherd/evaluate.h>
#include <sherd/files.h>
#include <sherd/folder.h>
#include <sherd/fracture.h>
#include <sherd/fragments.h>
#include <sherd/growth.h>
#include <sherd/labels.h>
#include <sherd/mesh.h>
#include <sherd/options.h>
#include <sherd/points.h>
#include <sherd/progress.h>
#include <sherd/render.h>
#include <sherd/seeds.h>
#include <sherd/solid.h>

namespace sherd {

/// Returns the version of the library, such as "0.1.0".
[[nodiscard]] const char* version();

}  // namespace sherd
