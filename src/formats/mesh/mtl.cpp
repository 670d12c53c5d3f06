// Material libraries of OBJ files.
//
// Read here because Assimp 5.2.5 reads beyond the end of some malformed ones.
#include "formats/mesh/mtl.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/text_scan.h"

namespace sherd {
namespace {

// Returns the name after the options of a map: "-s 1 1 1 -clamp on the bark.png".
std::string_view withoutOptions(std::string_view line) {
  constexpr std::array<std::pair<std::string_view, int>, 11> kWords{{{"-blendu", 1},
                                                                     {"-blendv", 1},
                                                                     {"-boost", 1},
                                                                     {"-bm", 1},
                                                                     {"-cc", 1},
                                                                     {"-clamp", 1},
                                                                     {"-imfchan", 1},
                                                                     {"-mm", 2},
                                                                     {"-texres", 1},
                                                                     {"-type", 1},
                                                                     {"-colorspace", 1}}};
  for (;;) {
    std::string_view rest = line;
    const std::string_view word = takeWord(rest);
    if (word == "-o" || word == "-s" || word == "-t") {  // one to three numbers
      for (int i = 0; i < 3; ++i) {
        std::string_view next = rest;
        if (!isNumber(takeWord(next))) break;
        rest = next;
      }
    } else {
      const auto* known = std::find_if(kWords.begin(), kWords.end(),
                                       [&](const auto& option) { return option.first == word; });
      if (known == kWords.end()) return trimmed(line);
      for (int i = 0; i < known->second; ++i) takeWord(rest);
    }
    line = rest;
  }
}

}  // namespace

void addMtl(std::string_view text, std::map<std::string, MtlMaterial>& materials) {
  MtlMaterial ignored;
  MtlMaterial* material = nullptr;
  LineReader lines(text);
  while (lines.next()) {
    std::string_view rest = lines.line();
    const std::string_view keyword = takeWord(rest);
    if (keyword == "newmtl") {
      const auto [at, isNew] = materials.try_emplace(std::string(trimmed(rest)));
      material = isNew ? &at->second : &ignored;
    } else if (material != nullptr && keyword == "Kd") {
      glm::vec3 color(0.0f);
      bool good = true;
      for (int i = 0; i < 3; ++i) {
        const auto value = parseReal(takeWord(rest));
        good = good && value && std::isfinite(*value);
        if (good) color[i] = std::clamp(static_cast<float>(*value), 0.0f, 1.0f);
      }
      if (good) material->color = color;
    } else if (material != nullptr && keyword == "map_Kd") {
      material->texture = withoutOptions(rest);
    }
  }
}

}  // namespace sherd
