// What the centres of a picture's pixels see.
#pragma once

#include <sherd/render.h>

#include <span>

#include "render/camera.h"
#include "render/scene.h"

namespace sherd {

/// Fill all layers but rgba.
///   fragments  those of the scene
///   up         RenderOptions::up
void traceCentres(std::span<const Fragment> fragments, const Scene& scene, const Camera& camera,
                  char up, Layers& layers);

}  // namespace sherd
