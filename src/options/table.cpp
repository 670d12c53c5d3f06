// The options of a fracture, in the order of a manifest's `options`.
#include <vector>

#include "options/rows.h"

namespace sherd {

std::span<const FractureOptionRow> fractureOptionTable() {
  static const std::vector<FractureOptionRow> kTable = [] {
    std::vector<FractureOptionRow> all;
    for (const auto& rows : {generalRows(), solidRows(), seedRows(), growthRows(), erosionRows(),
                             withheldRows(), pointRows(), fileRows(), surfaceRows()}) {
      all.insert(all.end(), rows.begin(), rows.end());
    }
    return all;
  }();
  return kTable;
}

const FractureOptionRow* fractureOption(std::string_view name) {
  for (const FractureOptionRow& row : fractureOptionTable()) {
    if (!row.hidden && (row.name == name || (*row.alias != '\0' && row.alias == name))) return &row;
  }
  return nullptr;
}

}  // namespace sherd
