// Thumbnails of some objects and fractures, for the report.
#pragma once

#include <sherd/dataset.h>
#include <sherd/fragments.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <set>
#include <span>
#include <string>

namespace sherd {

constexpr std::size_t kMaxThumbnails = 16;  ///< objects, and fractures of them, as in Figure 16
constexpr int kThumbnailSide = 200;         ///< pixels

/// Returns the names of an object's fractures that get a thumbnail, the intact object included;
/// empty for most objects of a large library.
///   object   index of the object, < objects
///   objects  number of objects
[[nodiscard]] std::set<std::string> thumbnailFractures(const Schedule& schedule, std::size_t object,
                                                       std::size_t objects);

/// The same of an assemblage: the first fractures.
[[nodiscard]] std::set<std::string> thumbnailFractures(const std::vector<PlannedFracture>& planned,
                                                       std::size_t object, std::size_t objects);

/// Whether an object has thumbnails.
[[nodiscard]] bool hasThumbnail(std::size_t object, std::size_t objects);

/// Returns the path of a fracture's thumbnail below the dataset's folder: beside the object's
/// journal, as it is not part of the dataset.
[[nodiscard]] std::string thumbnailName(const LibraryObject& object, const std::string& fracture);

/// Returns the path of a fracture's page of the viewer, beside its thumbnail.
[[nodiscard]] std::string viewerName(const LibraryObject& object, const std::string& fracture);

/// The largest size of a page's meshes and textures, bytes.
constexpr std::uint64_t kMaxViewerBytes = 4'000'000;

/// Renders fragments, exploded, to a PNG file.
///   up  the upward axis: 'x', 'y' or 'z'
///   throws  Error(output); std::bad_alloc, also where the renderer has no memory
void writeThumbnail(const std::filesystem::path& file, std::span<const Fragment> fragments,
                    char up);

}  // namespace sherd
