// Warnings of very small fragments.
#include "folder/manifest/small_pieces.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "base/text/formatted.h"

namespace sherd {
namespace {

constexpr double kSmallShare = 1e-3;    // of the solid
constexpr double kShareOfMean = 0.1;    // where that is less
constexpr double kShareOfVoxels = 0.1;  // that a surface encloses

// "fragment 3 has", "fragments 3, 7 and 12 have": the first ones by their ids.
std::string subject(const std::vector<int>& ids) {
  constexpr std::size_t kMostIds = 8;
  if (ids.size() == 1) return "fragment " + std::to_string(ids.front()) + " has";
  std::string text = "fragments ";
  const std::size_t shown = std::min(ids.size(), kMostIds);
  for (std::size_t i = 0; i < shown; ++i) {
    if (i > 0) text += i + 1 == ids.size() ? " and " : ", ";
    text += std::to_string(ids[i]);
  }
  if (shown < ids.size()) text += " and " + std::to_string(ids.size() - shown) + " more";
  return text + " have";
}

}  // namespace

std::vector<std::string> smallPieces(const FractureResult& result) {
  const auto voxels = static_cast<double>(result.solid.voxels);
  const double mean = 1.0 / static_cast<double>(std::max<std::size_t>(result.fragments.size(), 1));
  const double least = std::min(kSmallShare, kShareOfMean * mean);
  const double voxel = std::pow(result.solid.frame.voxelSize, 3);
  std::vector<int> small, hollow;
  for (const Fragment& fragment : result.fragments) {
    if (fragment.voxels == 0) continue;  // of a solid that is not broken
    const auto own = static_cast<double>(fragment.voxels);
    if (own < least * voxels) small.push_back(fragment.id);
    if (fragment.mass.volume < kShareOfVoxels * own * voxel) hollow.push_back(fragment.id);
  }
  std::vector<std::string> clauses;
  if (!small.empty()) {
    clauses.push_back(subject(small) + " less than " + formatted("%.2g %%", 100.0 * least) +
                      " of the solid" + (small.size() > 1 ? " each" : ""));
  }
  if (!hollow.empty()) {
    clauses.push_back(subject(hollow) + (hollow.size() > 1 ? " meshes" : " a mesh") +
                      " of less than a tenth of the volume of " +
                      (hollow.size() > 1 ? "their" : "its") + " voxels");
  }
  return clauses;
}

}  // namespace sherd
