// What presets draw for each fracture.
#include <sherd/options.h>

#include <string>
#include <string_view>
#include <vector>

namespace sherd {
namespace {

// Percentages of the roughness are of the longest side, those of noise of the diagonal. Relief of
// four broken objects is 0.7 %, the mismatch of a brick 0.14 % (docs/realism.md).
const std::vector<DrawnOption>& drawnInTraining() {
  static const std::vector<DrawnOption> kAll{{"roughness", "0.1%", "1.4%", {}},
                                             {"missing", "0.0", "0.2", {}},
                                             {"mismatch", "0%", "0.3%", {}},
                                             {"scan-noise", "0%", "0.1%", {}}};
  return kAll;
}

// Whether a draw can be beside what was chosen.
bool isPossible(const std::string& name, const RunOptions& options) {
  const FractureOptions& fracture = options.fracture;
  if (name == "roughness") return fracture.material == MaterialPreset::none;
  if (name == "missing") return true;
  if (fracture.surface.adaptivity > 0.0) return false;
  return name != "scan-noise" || fracture.surface.surface != Surface::exact;
}

}  // namespace

std::vector<DrawnOption> presetDraws(std::string_view preset, const RunOptions& options,
                                     const std::function<bool(std::string_view)>& isGiven) {
  std::vector<DrawnOption> all;
  if (preset != "training") return all;
  for (const DrawnOption& option : drawnInTraining()) {
    if (!isGiven(option.name) && isPossible(option.name, options)) all.push_back(option);
  }
  return all;
}

}  // namespace sherd
