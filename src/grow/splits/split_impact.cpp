// The pattern of an impact as splits.
#include "grow/splits/split_impact.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "base/random.h"

namespace sherd {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

// A number in -1..1.
double jitter(const SplitImpact& impact, std::uint64_t path) {
  return 2.0 * randomUnit(impact.seed, Stage::impactRing, mixed(path)) - 1.0;
}

// Half of the sectors, or of the rows.
int half(int count) { return (count + 1) / 2; }

ImpactSplit radialCrack(const SplitImpact& impact, const ImpactPart& part, std::uint64_t path) {
  const bool isWhole = part.to - part.from > 0.75 * kTurn;
  const int keptSectors = half(part.sectors);
  const double sector = (part.to - part.from) / part.sectors;
  // The first crack leads in both directions.
  const double angle = isWhole ? part.from + 0.5 * kTurn
                               : part.from + sector * (keptSectors + 0.25 * jitter(impact, path));
  ImpactSplit split{.center = impact.center};
  split.normal = std::cos(angle) * impact.v - std::sin(angle) * impact.u;  // to greater angles
  split.kept = split.added = part;
  split.kept->sectors = keptSectors;
  split.added->sectors = part.sectors - keptSectors;
  split.kept->to = split.added->from = angle;
  return split;
}

ImpactSplit ringCrack(const SplitImpact& impact, const ImpactPart& part, std::uint64_t path) {
  const int keptRows = half(part.lastRow - part.firstRow);
  const int row = part.firstRow + keptRows;
  const RingPattern& pattern = impact.pattern;
  // The last ring but one bounds the last row but one.
  const double radius = pattern.radius * std::pow(pattern.ratio, row - pattern.rings);
  ImpactSplit split{.center = impact.center};
  split.radius = radius * (1.0 + 0.2 * (1.0 - 1.0 / pattern.ratio) * jitter(impact, path));
  split.kept = split.added = part;
  split.kept->lastRow = split.added->firstRow = row;
  return split;
}

}  // namespace

ImpactPart wholePattern(std::span<const SplitImpact> impacts, std::size_t impact, std::size_t count,
                        std::uint64_t path) {
  const SplitImpact& of = impacts[impact];
  const int pieces = static_cast<int>(std::min({count, of.pieces, std::size_t{1} << 20}));
  ImpactPart whole;
  whole.impact = impact;
  whole.sectors = std::clamp(pieces, 1, of.pattern.radials);
  const int rows = of.pattern.rings + 1;
  // Without pieces for all, the outer rows are one.
  whole.lastRow = std::clamp(pieces / whole.sectors, 1, rows);
  whole.from = 0.5 * kTurn * jitter(of, path);
  whole.to = whole.from + kTurn;
  return whole;
}

ImpactSplit outerRing(std::span<const SplitImpact> impacts, const ImpactPart& whole,
                      std::size_t count, std::size_t nextImpact) {
  const SplitImpact& impact = impacts[whole.impact];
  ImpactSplit split{.center = impact.center, .radius = impact.outerRadius()};
  split.nextImpact = nextImpact;
  split.kept = whole;
  split.fixed = std::clamp(impact.pieces, std::size_t{1}, count - 1);
  return split;
}

std::optional<ImpactSplit> nextSplit(std::span<const SplitImpact> impacts, const ImpactPart& part,
                                     std::size_t nextImpact, std::uint64_t path) {
  const SplitImpact& impact = impacts[part.impact];
  std::optional<ImpactSplit> split;
  if (part.sectors > 1) {
    split = radialCrack(impact, part, path);
  } else if (part.lastRow - part.firstRow > 1) {
    split = ringCrack(impact, part, path);
  }
  if (split) split->nextImpact = nextImpact;
  return split;
}

std::size_t keptPieces(const ImpactSplit& split, std::size_t count, std::size_t kept,
                       std::size_t added) {
  if (split.fixed > 0) return std::clamp(split.fixed, std::size_t{1}, count - 1);
  const double share = static_cast<double>(kept) / static_cast<double>(kept + added);
  const auto whole = static_cast<double>(count);
  // A sliver, as of an impact at the edge of a plate, gets fewer pieces than it has cells.
  const auto cellsOf = [&](const std::optional<ImpactPart>& part, double own) {
    const double cells = part ? static_cast<double>(part->cells()) : 1.0;
    return split.radius > 0.0 ? cells : std::min(cells, 1.0 + std::floor(4.0 * own * whole));
  };
  const double ofKept = cellsOf(split.kept, share), ofAdded = cellsOf(split.added, 1.0 - share);
  const double rest = whole - ofKept - ofAdded;
  const double pieces = rest >= 0.0 ? ofKept + rest * share : whole * ofKept / (ofKept + ofAdded);
  return std::clamp(static_cast<std::size_t>(pieces + 0.5), std::size_t{1}, count - 1);
}

void afterMiss(const ImpactSplit& split, const glm::dvec3& mean, std::size_t& nextImpact,
               std::optional<ImpactPart>& part) {
  const glm::dvec3 from = mean - split.center;
  const bool isKept =
      split.radius > 0.0 ? glm::length(from) < split.radius : glm::dot(from, split.normal) <= 0.0;
  nextImpact = split.nextImpact;
  part = isKept ? split.kept : split.added;
}

}  // namespace sherd
