// Finds a growth rule by its name.
#include <sherd/error.h>
#include <sherd/growth.h>
#include <sherd/labels.h>

#include <string>

namespace sherd {

Growth growthNamed(std::string_view name) {
  for (std::size_t i = 0; i < std::size(kGrowthRules); ++i) {
    if (name == kGrowthRules[i].name) return static_cast<Growth>(i);
  }
  throw Error(ErrorCode::usage, "no growth rule has the name " + std::string(name));
}

}  // namespace sherd
