// The uses of textures in a material of glTF.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace sherd {

/// Calls keep(use) for each use of a texture in a material, an object with a number `index` under a
/// key that ends in "Texture", also in extensions, and removes those for which it returns false.
template <class Json, class Keep>
void forEachTextureUse(Json& object, const Keep& keep) {
  for (auto at = object.begin(); at != object.end();) {
    if (!at->is_object() || at.key() == "extras") {
      ++at;
      continue;
    }
    const bool isUse = at.key().ends_with("Texture") && at->contains("index");
    if (isUse && !keep(*at)) {
      at = object.erase(at);
      continue;
    }
    if (!isUse) forEachTextureUse(*at, keep);
    ++at;
  }
}

}  // namespace sherd
