// AOVs at pixel centers.
#pragma once

#include <sherd/render.h>

#include <span>

#include "render/camera.h"
#include "render/scene.h"

namespace sherd {

/// Fills every AOV except rgba, whose samples the renderer averages.
///   fragments  those that the scene was made from
///   up         RenderOptions::up
void traceCenters(std::span<const Fragment> fragments, const Scene& scene, const Camera& camera,
                  char up, Aovs& aovs);

}  // namespace sherd
