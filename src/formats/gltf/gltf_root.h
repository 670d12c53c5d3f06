// The root node of our glTF files, by which coordinates of the input are glTF's: meters, y up.
#pragma once

#include <sherd/mesh.h>

#include <nlohmann/json.hpp>
#include <optional>

namespace sherd {

/// Whether glTF's coordinates are a mesh's own.
[[nodiscard]] bool isOfGltf(const CoordinateSystem& coordinates);

/// Returns the rotation and scale of the root node.
[[nodiscard]] nlohmann::ordered_json rootTransform(const CoordinateSystem& coordinates);

/// Returns `extras` of the file's asset, by which a root node with the transform is known again.
[[nodiscard]] nlohmann::ordered_json assetExtras(const CoordinateSystem& coordinates);

/// Returns what coordinates below a root node mean: if the file is ours, and the node has exactly
/// the transform that its asset names.
[[nodiscard]] std::optional<CoordinateSystem> coordinatesBelow(const nlohmann::json& asset,
                                                               const nlohmann::json& root);

}  // namespace sherd
