// Thumbnails for the report.
#include "dataset/report/thumbnails.h"

#include <sherd/error.h>
#include <sherd/files.h>
#include <sherd/render.h>

#include <algorithm>
#include <new>

#include "dataset/layouts/fracture_line.h"

namespace sherd {

namespace {

// Spreads thumbnails evenly over the library: the index of the thumbnail object at or before this
// one.
std::size_t thumbnailIndex(std::size_t object, std::size_t objects) {
  return object * kMaxThumbnails / std::max(objects, kMaxThumbnails);
}

}  // namespace

bool hasThumbnail(std::size_t object, std::size_t objects) {
  return object == 0 || thumbnailIndex(object, objects) != thumbnailIndex(object - 1, objects);
}

std::set<std::string> thumbnailFractures(const Schedule& schedule, std::size_t object,
                                         std::size_t objects) {
  if (!hasThumbnail(object, objects)) return {};
  std::set<std::string> names{kWholeName};
  // A different number of pieces for each object; several for each if there are few objects.
  const std::size_t each =
      std::max<std::size_t>(kMaxThumbnails / std::max<std::size_t>(objects, 1), 1);
  const auto counts = static_cast<std::size_t>(schedule.most - schedule.fewest + 1);
  const std::vector<PlannedFracture> planned = fracturesOf(schedule);
  for (std::size_t k = 0; k < each; ++k) {
    const std::size_t nth = (thumbnailIndex(object, objects) * each + k) % counts;
    const PlannedFracture first{schedule.fewest + static_cast<int>(nth), 0};
    const bool isPlanned = std::any_of(planned.begin(), planned.end(), [&](const auto& other) {
      return other.name() == first.name();
    });
    if (isPlanned) names.insert(first.name());
  }
  return names;
}

std::set<std::string> thumbnailFractures(const std::vector<PlannedFracture>& planned,
                                         std::size_t object, std::size_t objects) {
  if (!hasThumbnail(object, objects)) return {};
  std::set<std::string> names{kWholeName};
  const std::size_t each =
      std::max<std::size_t>(kMaxThumbnails / std::max<std::size_t>(objects, 1), 1);
  for (std::size_t k = 0; k < std::min(each, planned.size()); ++k) names.insert(planned[k].name());
  return names;
}

std::string thumbnailName(const LibraryObject& object, const std::string& fracture) {
  return std::filesystem::path(journalName(object))
      .replace_extension("." + fracture + ".png")
      .generic_string();
}

std::string viewerName(const LibraryObject& object, const std::string& fracture) {
  return std::filesystem::path(thumbnailName(object, fracture))
      .replace_extension(".html")
      .generic_string();
}

namespace {

// An image that fails does so for want of memory: the object's failure, and not the output's.
Image rendered(std::span<const Fragment> fragments, const RenderOptions& options) try {
  return renderFragments(fragments, options);
} catch (const Error& e) {
  if (e.code() != ErrorCode::output) throw;
  throw std::bad_alloc();
}

}  // namespace

void writeThumbnail(const std::filesystem::path& file, std::span<const Fragment> fragments,
                    char up) {
  RenderOptions options;
  options.width = options.height = kThumbnailSide;
  options.up = up;
  writePng(file, rendered(fragments, options));
}

}  // namespace sherd
