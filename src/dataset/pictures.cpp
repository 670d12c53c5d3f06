// Pictures for the report.
#include "dataset/pictures.h"

#include <sherd/render.h>

#include <algorithm>

#include "dataset/fracture_line.h"

namespace sherd {

namespace {

// Spread evenly over the library: the number of the last pictured object up to this one.
std::size_t pictured(std::size_t object, std::size_t objects) {
  return object * kMostPictured / std::max(objects, kMostPictured);
}

}  // namespace

bool isPictured(std::size_t object, std::size_t objects) {
  return object == 0 || pictured(object, objects) != pictured(object - 1, objects);
}

std::set<std::string> picturedOf(const Schedule& schedule, std::size_t object,
                                 std::size_t objects) {
  if (!isPictured(object, objects)) return {};
  std::set<std::string> names{kWholeName};
  // Other numbers of pieces for each object, and several where objects are few.
  const std::size_t each =
      std::max<std::size_t>(kMostPictured / std::max<std::size_t>(objects, 1), 1);
  const auto counts = static_cast<std::size_t>(schedule.most - schedule.fewest + 1);
  const std::vector<PlannedFracture> planned = fracturesOf(schedule);
  for (std::size_t k = 0; k < each; ++k) {
    const std::size_t nth = (pictured(object, objects) * each + k) % counts;
    const PlannedFracture first{schedule.fewest + static_cast<int>(nth), 0};
    const bool isPlanned = std::any_of(planned.begin(), planned.end(), [&](const auto& other) {
      return other.name() == first.name();
    });
    if (isPlanned) names.insert(first.name());
  }
  return names;
}

std::string pictureName(const LibraryObject& object, const std::string& fracture) {
  return std::filesystem::path(journalName(object))
      .replace_extension("." + fracture + ".png")
      .generic_string();
}

void takePicture(const std::filesystem::path& file, std::span<const Fragment> fragments, char up) {
  RenderOptions options;
  options.width = options.height = kPictureSide;
  options.up = up;
  writePng(file, renderFragments(fragments, options));
}

}  // namespace sherd
