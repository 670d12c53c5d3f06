// Reading and writing seeds as JSON.
#include "folder/read/seed_file.h"

#include <sherd/error.h>
#include <sherd/files.h>

#include <nlohmann/json.hpp>
#include <string>

#include "base/files/parsed_json.h"
#include "base/input_error.h"

namespace sherd {
namespace {

using Json = nlohmann::json;  // ordered_json searches keys linearly
namespace fs = std::filesystem;

constexpr const char* kSchema = "sherd-seeds/1";
constexpr std::uintmax_t kLargestFile = std::uintmax_t{64} << 20;  // some 700,000 seeds

// Reads three numbers, or returns nothing.
std::optional<glm::dvec3> vectorIn(const Json& list) {
  if (!list.is_array() || list.size() != 3) return {};
  glm::dvec3 vector;
  for (int axis = 0; axis < 3; ++axis) {
    const Json& value = list[static_cast<std::size_t>(axis)];
    if (!value.is_number()) return {};
    vector[axis] = value.get<double>();
  }
  return vector;
}

SeedPoint pointOf(const Json& entry, std::size_t number) {
  const auto refuse = [&](const std::string& what) {
    inputError("seed " + std::to_string(number + 1) + " " + what);
  };
  if (!entry.is_object()) refuse("is not an object");
  const auto fragment = entry.find("fragment");
  if (fragment == entry.end() || !fragment->is_number_integer()) {
    refuse("has no whole number \"fragment\"");
  }
  const auto position = entry.find("position");
  const std::optional<glm::dvec3> at = position == entry.end() ? std::nullopt : vectorIn(*position);
  if (!at) refuse("has no \"position\" of three numbers");
  SeedPoint point;
  point.position = *at;
  const bool inRange =
      fragment->is_number_unsigned() && *fragment >= 1 && *fragment <= kMaxFragments;
  if (!inRange) {
    refuse("belongs to fragment " + fragment->dump() + ", ids go from 1 to " +
           std::to_string(kMaxFragments));
  }
  point.fragment = fragment->get<int>();
  return point;
}

}  // namespace

std::vector<SeedPoint> seedPoints(const Json& json) {
  if (!json.is_object()) inputError("is not a JSON object");
  const auto schema = json.find("schema");
  if (schema == json.end() || *schema != kSchema) {
    inputError(std::string("is no seed file: its \"schema\" is not \"") + kSchema + "\"");
  }
  const auto seeds = json.find("seeds");
  if (seeds == json.end() || !seeds->is_array()) inputError("has no list \"seeds\"");
  std::vector<SeedPoint> points;
  for (const Json& entry : *seeds) points.push_back(pointOf(entry, points.size()));
  const auto given = json.find("offset");
  if (given == json.end()) return points;
  const std::optional<glm::dvec3> offset = vectorIn(*given);
  if (!offset) inputError("has an \"offset\" that is not three numbers");
  for (SeedPoint& point : points) point.position += *offset;
  return points;
}

std::vector<SeedPoint> readSeedPoints(const fs::path& file) {
  const Json json = readJson(file, "seed file", kLargestFile);
  try {
    return seedPoints(json);
  } catch (const Error& e) {
    throw Error(e.code(), file.string() + ": " + e.what(), e.options());
  }
}

void writeSeeds(const OutputFile& file, std::span<const Seed> seeds, const Solid& solid,
                const std::optional<glm::dvec3>& offset) {
  std::string text = "{\n \"schema\": \"" + std::string(kSchema) + "\",";
  if (offset) text += "\n \"offset\": " + Json{offset->x, offset->y, offset->z}.dump() + ",";
  text += "\n \"seeds\": [";
  const char* separator = "\n";
  const double step = solid.frame.voxelSize / kSeedSteps;  // world units
  for (const Seed& seed : seeds) {
    const glm::dvec3 point = solid.frame.worldFromIndex(pointOf(seed));
    // Adding zero replaces -0 by 0.
    Json entry = {{"fragment", seed.fragment},
                  {"position", {point.x + 0.0, point.y + 0.0, point.z + 0.0}}};
    if (seed.weight != 0) entry["weight"] = static_cast<double>(seed.weight) * step * step;
    text += separator + ("  " + entry.dump());
    separator = ",\n";
  }
  text += "\n ]\n}\n";
  file.write(text);
}

}  // namespace sherd
