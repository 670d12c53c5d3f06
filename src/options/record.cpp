// Writes and reads a manifest's `options`.
#include "options/record.h"

#include <sherd/error.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <string_view>

#include "base/text/density_source.h"
#include "base/text/json_of.h"
#include "base/text/option_text.h"
#include "options/parsed.h"

namespace sherd {
namespace {

using Json = nlohmann::ordered_json;
using In = nlohmann::json;

constexpr std::string_view kImpacts = "seeds.impacts", kSeedFile = "seeds.file",
                           kDensity = "seeds.density", kGuides = "guides";

Json impactJson(const Impact& impact) {
  Json json = Json::object();
  const bool isMoved = !std::holds_alternative<Impact::Anywhere>(impact.given);
  const auto& target = isMoved ? impact.given : impact.target;
  if (const auto* point = std::get_if<WorldPoint>(&target)) json["point"] = jsonOf(*point);
  if (const auto* ray = std::get_if<Ray>(&target)) {
    json["ray"] = {{"origin", jsonOf(ray->origin)}, {"direction", jsonOf(ray->direction)}};
  }
  json["count"] = impact.count;
  if (impact.sigma > 0.0) {
    json["sigma"] = impact.sigma;
  } else {
    json["bias"] = impact.bias;
  }
  if (impact.energy > 0.0) json["energy"] = impact.energy;
  json["merge"] = impact.merge;
  return json;
}

Json impactsJson(const std::vector<Impact>& impacts) {
  Json all = Json::array();
  for (const Impact& impact : impacts) all.push_back(impactJson(impact));
  return all;
}

// Files are recorded without folders.
std::string fileName(const std::string& path) {
  return std::filesystem::path(path).filename().string();
}

Json guidesJson(const std::vector<Guide>& guides) {
  Json all = Json::array();
  for (const Guide& guide : guides) {
    Json one = {{"file", fileName(guide.file)}};
    if (!guide.sha256.empty()) one["sha256"] = guide.sha256;
    all.push_back(std::move(one));
  }
  return all;
}

glm::dvec3 vectorFrom(const In& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

Impact impactOfJson(const In& json) {
  Impact impact;
  if (json.contains("point")) impact.target = glm::dvec3{vectorFrom(json.at("point"))};
  if (json.contains("ray")) {
    const In& ray = json.at("ray");
    impact.target = Ray{{vectorFrom(ray.at("origin"))}, vectorFrom(ray.at("direction"))};
  }
  impact.count = json.at("count").get<int>();
  impact.sigma = json.value("sigma", impact.sigma);
  impact.bias = json.value("bias", impact.bias);
  impact.energy = json.value("energy", impact.energy);
  impact.merge = json.at("merge").get<bool>();
  return impact;
}

// Returns a whole number, or the text where it is none, such as "auto".
Json wholeJson(const std::string& text) {
  const char* const end = text.data() + text.size();
  std::uint64_t number = 0;
  const auto [stop, error] = std::from_chars(text.data(), end, number);
  return error == std::errc() && stop == end ? Json(number) : Json(text);
}

Json listJson(const std::string& text, Json (*jsonOfPart)(const std::string&)) {
  Json list = Json::array();
  if (text.empty()) return list;
  for (const std::string& part : split(text)) list.push_back(jsonOfPart(part));
  return list;
}

// Returns a number, or the text where it is none.
Json numberJson(const std::string& text) {
  const std::optional<double> number = numberIn(text);
  return number ? Json(plain(*number)) : Json(text);
}

Json valueJson(OptionType type, const std::string& text) {
  switch (type) {
    case OptionType::flag:
      return text == "true";
    case OptionType::whole:
      return wholeJson(text);
    case OptionType::number:
      return numberJson(text);
    case OptionType::length:
      if (const Json whole = wholeJson(text); whole.is_number()) return whole;
      if (const std::optional<double> number = numberIn(text)) return *number;
      break;
    case OptionType::choices:
      return listJson(text, [](const std::string& part) { return Json(part); });
    case OptionType::wholes:
      return listJson(text, wholeJson);
    case OptionType::numbers:
      return listJson(text, numberJson);
    case OptionType::choice:
    case OptionType::text:
      break;
  }
  return text;
}

Json jsonOfRow(const FractureOptionRow& row, const RunOptions& options) {
  if (row.key == kImpacts) return impactsJson(options.fracture.seeds.impacts);
  const std::string text = row.value.text(options);
  if (row.key == kGuides) return guidesJson(options.fracture.guides);
  if (row.key == kSeedFile) return fileName(text);
  if (row.key == kDensity) return densitySourceOf(text).withoutFolders();
  return valueJson(row.value.type, text);
}

std::string textFrom(const In& json) {
  if (json.is_string()) return json.get<std::string>();
  if (!json.is_array()) return json.dump();
  std::vector<std::string> parts;
  for (const In& part : json) parts.push_back(textFrom(part));
  return joinedText(parts, ",");
}

}  // namespace

Json recordedOptions(const RunOptions& options, bool isRefracture) {
  Json json = Json::object();
  for (const FractureOptionRow& row : fractureOptionTable()) {
    if (*row.key == '\0' || (row.recorded != nullptr && !row.recorded(options))) continue;
    if (isRefracture && std::string_view(row.group) == "Solid") continue;
    Json* at = &json;
    for (const std::string& part : split(row.key, '.')) at = &(*at)[part];
    *at = jsonOfRow(row, options);
  }
  return json;
}

RunOptions optionsRecorded(const In& recorded) {
  RunOptions options;
  for (const FractureOptionRow& row : fractureOptionTable()) {
    if (*row.key == '\0') continue;
    const In* at = &recorded;
    for (const std::string& part : split(row.key, '.')) {
      at = at != nullptr && at->is_object() && at->contains(part) ? &at->at(part) : nullptr;
    }
    if (at == nullptr) continue;
    try {
      if (row.key == kImpacts) {
        for (const In& impact : *at) options.fracture.seeds.impacts.push_back(impactOfJson(impact));
      } else if (row.key == kGuides) {
        for (const In& guide : *at) {
          row.value.set(options, guide.at("file").get<std::string>());
          options.fracture.guides.back().sha256 = guide.value("sha256", "");
        }
      } else if (!at->is_array() || !at->empty()) {
        row.value.set(options, textFrom(*at));
      }
    } catch (const nlohmann::json::exception&) {
      throw Error(ErrorCode::input, std::string("its option ") + row.key + " is damaged");
    } catch (const Error& e) {
      throw Error(ErrorCode::input, std::string("its option ") + row.key + ": " + e.what(),
                  e.options());
    }
  }
  return options;
}

}  // namespace sherd
