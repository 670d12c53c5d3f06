// The option table, as Python sees it.
#include "options.h"

#include <nanobind/stl/pair.h>
#include <nanobind/stl/set.h>
#include <nanobind/stl/vector.h>
#include <sherd/error.h>
#include <sherd/files.h>
#include <sherd/folder.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "folder/manifest/read_manifest.h"
#include "options/record.h"
#include "text.h"

namespace pysherd {

namespace nb = nanobind;
using sherd::Error;
using sherd::ErrorCode;
using sherd::FractureOptionRow;
using sherd::RunOptions;

namespace {

constexpr const char* kTypes[] = {"flag",    "whole",  "number",  "length", "choice",
                                  "choices", "wholes", "numbers", "text"};

// Returns the default as text; empty where the option has none that could be given.
std::string defaultOf(const FractureOptionRow& row) {
  RunOptions options;
  const std::string text = row.value.text(options);
  try {
    row.value.set(options, text);
  } catch (const Error&) {
    return {};
  }
  return text;
}

nb::dict dictOf(const FractureOptionRow& row) {
  nb::dict dict;
  dict["name"] = row.name;
  dict["keyword"] = keywordOf(row.name);
  dict["alias"] = keywordOf(row.alias);
  dict["group"] = row.group;
  dict["type"] = kTypes[static_cast<std::size_t>(row.value.type)];
  dict["range"] = row.value.range;
  dict["choices"] = row.value.choices;
  dict["default"] = defaultOf(row);
  dict["unit"] = row.unit;
  dict["help"] = row.help;
  dict["repeats"] = row.repeats;
  return dict;
}

nb::list table() {
  nb::list rows;
  for (const FractureOptionRow& row : sherd::fractureOptionTable()) {
    if (!row.hidden) rows.append(dictOf(row));
  }
  return rows;
}

void setRow(RunOptions& options, const FractureOptionRow& row, const std::string& text) {
  try {
    row.value.set(options, text);
  } catch (const Error& e) {
    throw Error(e.code(), keywordOf(row.name) + ": " + e.what());
  }
}

void checkRelations(const FractureOptionRow& row, const GivenOptions& given) {
  if (*row.excludes != '\0' && isGiven(given, row.excludes)) {
    throw Error(ErrorCode::usage, keywordOf(row.name) + " cannot be given with " +
                                      keywordOf(row.excludes) + "; omit one of them");
  }
  if (*row.needs != '\0' && !isGiven(given, row.needs)) {
    throw Error(ErrorCode::usage, keywordOf(row.name) + " needs " + keywordOf(row.needs));
  }
}

// Returns the options that a fracture's manifest records.
GivenOptions optionsOfManifest(const std::string& file) {
  const auto manifest = sherd::manifestJson(file);
  if (!manifest) throw Error(ErrorCode::input, file + ": is not a fracture's manifest");
  return givenOf(sherd::optionsRecorded(manifest->value("options", nlohmann::json::object())));
}

}  // namespace

GivenOptions givenOf(const RunOptions& recorded) {
  const RunOptions usual;
  RunOptions ofMaterial;
  ofMaterial.fracture = sherd::materialOptions(recorded.fracture.material);
  GivenOptions given;
  for (const FractureOptionRow& row : sherd::fractureOptionTable()) {
    std::string text = row.value.text(recorded);
    const bool isMaterial = std::string_view(row.name) == "material";
    if (row.hidden || text == row.value.text(isMaterial ? usual : ofMaterial)) continue;
    if (text.empty()) text = "none";  // of an option that the material has
    std::istringstream parts(text);   // those of an option that repeats are separated by spaces
    for (std::string part; row.repeats && parts >> part;) given.emplace_back(row.name, part);
    if (!row.repeats) given.emplace_back(row.name, text);
  }
  if (isGiven(given, "seeds")) {  // which have the number of pieces
    std::erase_if(given, [](const auto& option) { return option.first == "pieces"; });
  }
  return given;
}

std::string keywordOf(std::string name) {
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

bool isGiven(const GivenOptions& given, const char* name) {
  return std::any_of(given.begin(), given.end(),
                     [&](const auto& option) { return option.first == name; });
}

RunOptions optionsFrom(const GivenOptions& given) { return optionsFrom(given, RunOptions()); }

RunOptions optionsFrom(const GivenOptions& given, RunOptions options) {
  for (const FractureOptionRow& row : sherd::fractureOptionTable()) {  // the preset comes first
    for (const auto& [name, text] : given) {
      if (row.hidden || name != row.name) continue;
      setRow(options, row, text);
      checkRelations(row, given);
    }
  }
  auto& seeds = options.fracture.seeds.given;
  if (seeds && seeds->points.empty()) seeds->points = sherd::readSeedPoints(seeds->file);
  options.volume.ownVoxels =
      !isGiven(given, "voxel-size") && options.fracture.solid.resolution == sherd::kAutoResolution;
  return options;
}

GivenOptions drawnByPreset(const GivenOptions& given, RunOptions& options) {
  GivenOptions drawn;
  for (const auto& [name, preset] : given) {
    if (name != "preset") continue;
    const auto isOneGiven = [&](std::string_view other) {
      return isGiven(given, std::string(other).c_str());
    };
    for (const sherd::DrawnOption& option : sherd::presetDraws(preset, options, isOneGiven)) {
      drawn.emplace_back(option.name, option.valueFor(options.fracture.seed));
      setRow(options, *sherd::fractureOption(option.name), drawn.back().second);
    }
  }
  return drawn;
}

sherd::OptionUse useOf(std::vector<std::string> names, std::string input) {
  return {.isGiven =
              [names = std::move(names)](std::string_view name) {
                return std::find(names.begin(), names.end(), name) != names.end();
              },
          .spelled = [](std::string_view name) { return keywordOf(std::string(name)); },
          .input = std::move(input)};
}

void bindOptions(nb::module_& module) {
  module.def("option_table", table);
  module.def(
      "idle_options",
      [](const GivenOptions& given, std::vector<std::string> names, std::string input,
         std::set<std::string, std::less<>> drawn) {
        sherd::OptionUse use = useOf(std::move(names), std::move(input));
        const RunOptions options = optionsFrom(given);
        RunOptions tried = options;
        for (const auto& [name, text] : drawnByPreset(given, tried)) drawn.insert(name);
        use.isDrawn = [&](std::string_view name) { return drawn.contains(name); };
        return idleOptions(options, use);
      },
      nb::arg("given"), nb::arg("names"), nb::arg("input"),
      nb::arg("drawn") = std::set<std::string, std::less<>>{});
  module.def("check_options", [](const GivenOptions& given) { (void)optionsFrom(given); });
  module.def("recorded_options", optionsOfManifest);
}

}  // namespace pysherd
