// The page of the viewer.
#pragma once

#include <sherd/progress.h>

#include <cstdint>
#include <string>
#include <vector>

#include "viewer/scene.h"

namespace sherd {

/// A page, with a sentence for each thing that it leaves out.
struct ViewerPage {
  std::string html;
  std::vector<std::string> warnings;
};

/// Makes a self-contained HTML page: the viewer's program and style, and the scene
/// (docs/viewer.md). Its bytes depend on the arguments only.
///   maxBytes  of the data; meshes are simplified, and textures left out, until they fit
///   throws    Error(cancelled)
[[nodiscard]] ViewerPage viewerPage(const ViewerScene& scene, std::uint64_t maxBytes,
                                    const Progress* progress = nullptr);

}  // namespace sherd
