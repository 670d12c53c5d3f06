// Small pictures of some objects and fractures, for the report.
#pragma once

#include <sherd/dataset.h>
#include <sherd/fragments.h>

#include <cstddef>
#include <filesystem>
#include <set>
#include <span>
#include <string>

namespace sherd {

constexpr std::size_t kMostPictured = 16;  ///< objects, and fractures of them, as in Figure 16
constexpr int kPictureSide = 200;          ///< pixels

/// Which fractures of an object are pictured, by name, the unbroken one among them; none for most
/// objects of a large library.
///   object, objects  its number, and how many there are
[[nodiscard]] std::set<std::string> picturedOf(const Schedule& schedule, std::size_t object,
                                               std::size_t objects);

/// Whether an object is pictured at all.
[[nodiscard]] bool isPictured(std::size_t object, std::size_t objects);

/// Where the picture of a fracture lies below the dataset's folder: beside the object's journal, as
/// it is none of the dataset.
[[nodiscard]] std::string pictureName(const LibraryObject& object, const std::string& fracture);

/// Take a picture of fragments, exploded.
///   throws  Error(output)
void takePicture(const std::filesystem::path& file, std::span<const Fragment> fragments, char up);

}  // namespace sherd
