// Sherd breaks 3D models: mesh -> solid -> labels -> fragments -> files.  This header includes the
// whole library.
#pragma once

#include <sherd/dataset.h>
#include <sherd/device.h>
#include <sherd/error.h>
#include <sherd/evaluate.h>
#include <sherd/files.h>
#include <sherd/folder.h>
#include <sherd/fracture.h>
#include <sherd/fragments.h>
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
