// Values of options with a syntax of their own.
#include "options/parsed.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <optional>
#include <span>

#include "base/text/option_names.h"
#include "base/text/option_text.h"
#include "options/values.h"

namespace sherd {
namespace {

// What an option is without a direction, as its empty text cannot be given.
constexpr const char* kNone = "none";

bool isWhole(double value) { return value == std::floor(value); }

std::string numbersText(std::initializer_list<double> numbers) {
  std::vector<std::string> parts;
  for (const double number : numbers) parts.push_back(shortestText(number));
  return joinedText(parts, ",");
}

}  // namespace

void setExtraSeeds(SeedOptions& seeds, const std::string& text) {
  std::string digits = text;
  const bool perPiece = !digits.empty() && digits.back() == 'n';
  if (perPiece) digits.pop_back();
  int count = 0;
  const char* end = digits.data() + digits.size();
  const auto [stop, error] = std::from_chars(digits.data(), end, count);
  const int most = perPiece ? 1000 : 10'000'000;
  if (error != std::errc() || stop != end || count < 0 || count > most) {
    refuseValue(text, "a whole number, or a whole number followed by n as in 2n");
  }
  seeds.extraSeedsPerPiece = perPiece ? count : 0;
  seeds.extraSeeds = perPiece ? 0 : count;
}

std::string extraSeedsText(const SeedOptions& seeds) {
  return seeds.extraSeedsPerPiece > 0 ? std::to_string(seeds.extraSeedsPerPiece) + "n"
                                      : std::to_string(seeds.extraSeeds);
}

Impact impactFrom(const std::string& text) {
  const std::string expected =
      "x,y,z or ray:ox,oy,oz,dx,dy,dz, then optionally ,count ,sigma (or n=5) ,energy=0.01..100 "
      "and ,merge";
  const bool isRay = text.starts_with("ray:");
  std::vector<std::string> parts = split(isRay ? text.substr(4) : text);
  Impact impact;
  if (parts.back() == "merge") {
    impact.merge = true;
    parts.pop_back();
  }
  if (parts.size() > 1 && parts.back().starts_with("energy=")) {
    const std::optional<double> energy = numberIn(parts.back().substr(7));
    if (!energy || !(*energy >= 0.01 && *energy <= 100.0)) refuseValue(text, expected);
    impact.energy = *energy;
    parts.pop_back();
  }
  const std::size_t coordinates = isRay ? 6 : 3;
  if (parts.size() < coordinates || parts.size() > coordinates + 2) refuseValue(text, expected);
  const auto at = numbersIn(std::span(parts).first(coordinates));
  if (!at) refuseValue(text, expected);
  const std::vector<double>& v = *at;
  if (isRay) {
    impact.target = Ray{{v[0], v[1], v[2]}, {v[3], v[4], v[5]}};
  } else {
    impact.target = glm::dvec3{v[0], v[1], v[2]};
  }
  if (parts.size() > coordinates) {
    const std::optional<double> count = numberIn(parts[coordinates]);
    if (!count || *count < 1 || *count > kMaxFragments || !isWhole(*count)) {
      refuseValue(text, expected);
    }
    impact.count = static_cast<int>(*count);
  }
  if (parts.size() > coordinates + 1) {
    const std::string& sigma = parts[coordinates + 1];
    const bool isBias = sigma.starts_with("n=");
    const std::optional<double> value = numberIn(isBias ? sigma.substr(2) : sigma);
    if (!value || *value <= 0 || (isBias && (*value > kMaxBias || !isWhole(*value))) ||
        (isBias && impact.energy > 0.0)) {
      refuseValue(text, expected);
    }
    if (isBias) {
      impact.bias = static_cast<int>(*value);
    } else {
      impact.sigma = *value;
    }
  }
  return impact;
}

std::string impactText(const Impact& impact) {
  std::string text;
  if (const auto* point = std::get_if<WorldPoint>(&impact.target)) {
    text = numbersText({point->x, point->y, point->z});
  } else if (const auto* ray = std::get_if<Ray>(&impact.target)) {
    const glm::dvec3 &o = ray->origin, &d = ray->direction;
    text = "ray:" + numbersText({o.x, o.y, o.z, d.x, d.y, d.z});
  }
  if (impact.count > 0) {
    text += "," + std::to_string(impact.count);
    if (impact.sigma > 0.0) {
      text += "," + shortestText(impact.sigma);
    } else if (impact.bias != Impact{}.bias) {
      text += ",n=" + std::to_string(impact.bias);
    }
  }
  if (impact.energy > 0.0) text += ",energy=" + shortestText(impact.energy);
  return text + (impact.merge ? ",merge" : "");
}

void setGrain(Anisotropy& grain, const std::string& text) {
  if (text == kNone) {
    grain = {};
    return;
  }
  const auto numbers = numbersIn(split(text));
  if (!numbers || numbers->size() != 4 || (*numbers)[3] < -0.75 || (*numbers)[3] > 9.0 ||
      ((*numbers)[0] == 0.0 && (*numbers)[1] == 0.0 && (*numbers)[2] == 0.0)) {
    refuseValue(text, "dx,dy,dz,strength with a strength in -0.75..9, or none");
  }
  grain = {{(*numbers)[0], (*numbers)[1], (*numbers)[2]}, (*numbers)[3]};
}

std::string grainText(const Anisotropy& grain) {
  if (grain.strength == 0.0) return "";
  return numbersText({grain.direction.x, grain.direction.y, grain.direction.z, grain.strength});
}

void setDirection(Anisotropy& grain, const std::string& text) {
  const auto numbers = numbersIn(split(text));
  if (!numbers || numbers->size() != 3) refuseValue(text, "dx,dy,dz");
  grain.direction = {(*numbers)[0], (*numbers)[1], (*numbers)[2]};
}

std::string directionText(const Anisotropy& grain) {
  return numbersText({grain.direction.x, grain.direction.y, grain.direction.z});
}

void setSizes(ShareOptions& shares, const std::string& text) {
  const std::size_t colon = text.find(':');
  const std::string name = text.substr(0, colon);
  const auto found = std::find(std::begin(names::kSizes), std::end(names::kSizes), name);
  const auto sizes = static_cast<Sizes>(found - std::begin(names::kSizes));
  const bool hasParameter = sizes == Sizes::lognormal || sizes == Sizes::power;
  // A missing parameter is out of every range.
  const double parameter =
      colon == text.npos ? 0.0 : numberIn(text.substr(colon + 1)).value_or(0.0);
  const bool good = found != std::end(names::kSizes) && hasParameter == (colon != text.npos) &&
                    (sizes != Sizes::lognormal || (parameter >= 0.01 && parameter <= 3.0)) &&
                    (sizes != Sizes::power || (parameter >= 1.0 && parameter <= 4.0));
  if (!good) {
    refuseValue(text,
                "grown, uniform, exponential, lognormal:s with s in 0.01..3, or power:t with t in "
                "1..4");
  }
  shares.sizes = sizes;
  shares.sizeParameter = parameter;
}

std::string sizesText(const ShareOptions& shares) {
  const std::string name = names::of(names::kSizes, shares.sizes);
  const bool hasParameter = shares.sizes == Sizes::lognormal || shares.sizes == Sizes::power;
  return hasParameter ? name + ":" + shortestText(shares.sizeParameter) : name;
}

void setRoughness(GrowOptions& grow, const std::string& text) {
  const std::vector<std::string> parts = split(text);
  const std::optional<Length> height = lengthIn(parts[0]);
  const GrowOptions usual;
  const std::optional<double> hurst = parts.size() > 1 ? numberIn(parts[1]) : usual.hurst;
  const std::optional<Length> window =
      parts.size() > 2 ? lengthIn(parts[2]) : usual.roughnessWindow;
  const bool good = parts.size() <= 3 && height && height->voxels <= 100.0 && hurst &&
                    *hurst >= 0.1 && *hurst <= 1.0 && window;
  if (!good) {
    refuseValue(text,
                "r, r,H or r,H,W with r in 0..100 voxels, or in % of the longest side, H in "
                "0.1..1, and W in voxels or %");
  }
  grow.roughness = *height;
  grow.hurst = *hurst;
  grow.roughnessWindow = *window;
}

std::string roughnessText(const GrowOptions& grow) {
  const bool hasWindow = !grow.roughnessWindow.isZero();
  const bool hasHurst = hasWindow || grow.hurst != GrowOptions{}.hurst;
  return lengthText(grow.roughness) + (hasHurst ? "," + shortestText(grow.hurst) : "") +
         (hasWindow ? "," + lengthText(grow.roughnessWindow) : "");
}

void setNoise(NoiseOptions& noise, const std::string& text) {
  const std::vector<std::string> parts = split(text);
  const NoiseOptions usual;
  const auto percentIn = [](const std::string& part) -> std::optional<double> {
    const std::optional<Length> length = lengthIn(part);
    return length && length->voxels == 0.0 ? std::optional(length->percent) : std::nullopt;
  };
  const std::optional<double> rms = percentIn(parts[0]);
  const std::optional<double> hurst = parts.size() > 1 ? numberIn(parts[1]) : usual.hurst;
  const std::optional<double> wavelength =
      parts.size() > 2 ? percentIn(parts[2]) : usual.wavelength;
  const bool good = parts.size() <= 3 && rms && *rms <= 5.0 && hurst && *hurst >= 0.1 &&
                    *hurst <= 1.0 && wavelength && *wavelength >= 0.01;
  if (!good) {
    refuseValue(text,
                "P%, P%,H or P%,H,W% with P in 0..5 % of the diagonal, H in 0.1..1, and W in "
                "0.01..100 %");
  }
  noise = {*rms, *hurst, *wavelength};
}

std::string noiseText(const NoiseOptions& noise) {
  const NoiseOptions usual;
  const bool hasWavelength = noise.wavelength != usual.wavelength;
  const bool hasHurst = hasWavelength || noise.hurst != usual.hurst;
  return shortestText(noise.rms) + "%" + (hasHurst ? "," + shortestText(noise.hurst) : "") +
         (hasWavelength ? "," + shortestText(noise.wavelength) + "%" : "");
}

void setPropagation(GrowOptions& grow, const std::string& text) {
  if (text == kNone) {
    grow.propagationHurst = GrowOptions{}.propagationHurst;
    grow.propagation = GrowOptions{}.propagation;
    return;
  }
  const auto numbers = numbersIn(split(text));
  if (!numbers || numbers->size() != 4 || (*numbers)[3] < 0.1 || (*numbers)[3] > 1.0 ||
      ((*numbers)[0] == 0.0 && (*numbers)[1] == 0.0 && (*numbers)[2] == 0.0)) {
    refuseValue(text, "dx,dy,dz,H with H in 0.1..1, or none");
  }
  grow.propagation = {(*numbers)[0], (*numbers)[1], (*numbers)[2]};
  grow.propagationHurst = (*numbers)[3];
}

std::string propagationText(const GrowOptions& grow) {
  if (grow.propagationHurst == 0.0) return "";
  const glm::dvec3& d = grow.propagation;
  return numbersText({d.x, d.y, d.z, grow.propagationHurst});
}

void setPropagationDirection(GrowOptions& grow, const std::string& text) {
  const auto numbers = numbersIn(split(text));
  if (!numbers || numbers->size() != 3) refuseValue(text, "dx,dy,dz");
  grow.propagation = {(*numbers)[0], (*numbers)[1], (*numbers)[2]};
}

std::string propagationDirectionText(const GrowOptions& grow) {
  return numbersText({grow.propagation.x, grow.propagation.y, grow.propagation.z});
}

void setMissing(double& missing, const std::string& text) {
  const std::optional<double> value = numberIn(text);
  const bool good =
      value && *value >= 0.0 && *value <= kMaxFragments && (*value < 1.0 || isWhole(*value));
  if (!good) refuseValue(text, "a whole number of fragments, or a share below 1");
  missing = *value;
}

void setIterations(Iterations& iterations, const std::string& text) {
  const bool perVoxel = text.ends_with('k');
  const std::optional<double> value = numberIn(text.substr(0, text.size() - perVoxel));
  const bool good = value && *value >= 0.0 && *value <= (perVoxel ? 1.0 : 1000.0) &&
                    (perVoxel || isWhole(*value));
  if (!good) refuseValue(text, "a whole number in 0..1000, or F in 0..1 times k as in 0.048k");
  iterations = {.count = perVoxel ? 0 : static_cast<int>(*value),
                .perVoxel = perVoxel ? *value : 0.0};
}

std::string iterationsText(const Iterations& iterations) {
  return iterations.perVoxel > 0.0 ? shortestText(iterations.perVoxel) + "k"
                                   : std::to_string(iterations.count);
}

namespace {

struct WrittenName {
  const char* name;
  bool& (*of)(WriteOptions& write);
};

constexpr WrittenName kWritten[] = {
    {"labels", [](WriteOptions& w) -> bool& { return w.labels; }},
    {"vdb", [](WriteOptions& w) -> bool& { return w.vdb; }},
    {"mesh", [](WriteOptions& w) -> bool& { return w.mesh; }},
    {"preview", [](WriteOptions& w) -> bool& { return w.preview; }},
    {"seeds", [](WriteOptions& w) -> bool& { return w.seeds; }},
    {"boundaries", [](WriteOptions& w) -> bool& { return w.boundaries; }},
    {"cost", [](WriteOptions& w) -> bool& { return w.cost; }},
    {"fog", [](WriteOptions& w) -> bool& { return w.vdbOptions.fog; }},
    {"solid", [](WriteOptions& w) -> bool& { return w.solid; }},
    {"scene", [](WriteOptions& w) -> bool& { return w.scene; }},
    {"usd", [](WriteOptions& w) -> bool& { return w.usd; }},
    {"graph", [](WriteOptions& w) -> bool& { return w.graph; }},
    {"houdini", [](WriteOptions& w) -> bool& { return w.houdini; }},
    {"viewer", [](WriteOptions& w) -> bool& { return w.viewer; }},
    {"proxy", [](WriteOptions& w) -> bool& { return w.proxy; }},
};

// Files that are written if there is a number of points, whatever the list says; the list alone
// means this number.
constexpr const char* kPointFiles = "points";
constexpr std::size_t kListedPoints = 1000;

}  // namespace

std::vector<std::string> writtenNames() {
  std::vector<std::string> names;
  for (const WrittenName& file : kWritten) names.emplace_back(file.name);
  names.emplace_back(kPointFiles);
  return names;
}

void setWritten(WriteOptions& write, const std::string& text) {
  WriteOptions all = write;
  for (const WrittenName& file : kWritten) file.of(all) = false;
  const std::vector<std::string> names = writtenNames();
  for (const std::string& part : split(text)) {
    const std::size_t i = indexOf(part, names);
    if (i < std::size(kWritten)) {
      kWritten[i].of(all) = true;
    } else if (all.points.count == 0) {
      all.points.count = kListedPoints;
    }
  }
  write = std::move(all);
}

std::string writtenText(const WriteOptions& write) {
  WriteOptions all = write;
  std::vector<std::string> names;
  for (const WrittenName& file : kWritten) {
    if (file.of(all)) names.emplace_back(file.name);
  }
  if (write.points.count > 0) names.emplace_back(kPointFiles);
  return joinedText(names, ",");
}

void setTriangles(std::vector<std::size_t>& triangles, const std::string& text) {
  constexpr std::size_t kFewest = 4, kMost = 1'000'000'000;
  std::vector<std::size_t> numbers;
  for (const std::string& part : split(text)) numbers.push_back(wholeFrom(part, kFewest, kMost));
  triangles = std::move(numbers);
}

std::string trianglesText(const std::vector<std::size_t>& triangles) {
  std::vector<std::string> parts;
  for (const std::size_t number : triangles) parts.push_back(std::to_string(number));
  return joinedText(parts, ",");
}

}  // namespace sherd
