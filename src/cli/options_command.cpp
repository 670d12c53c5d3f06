// `sherd options`: the tables of options, for other programs and documents.
#include <sherd/dataset.h>
#include <sherd/options.h>

#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "cli/arguments/table_options.h"
#include "cli/terminal/command.h"

namespace sherd::cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kTypes[] = {"flag",    "whole",  "number",  "length", "choice",
                                  "choices", "wholes", "numbers", "text"};

// Adds a member unless the text is empty.
void add(Json& json, const char* key, const std::string& text) {
  if (!text.empty()) json[key] = text;
}

template <class Target>
Json rowJson(const OptionRow<Target>& row, const Target& defaults) {
  Json json = {{"name", row.name}, {"type", kTypes[static_cast<std::size_t>(row.value.type)]}};
  add(json, "group", row.group);
  add(json, "range", row.value.range);
  if (!row.value.choices.empty()) json["choices"] = row.value.choices;
  add(json, "default", defaultText(row.value, defaults));
  add(json, "unit", row.unit);
  add(json, "help", row.help);
  add(json, "details", row.details);
  add(json, "key", row.key);
  add(json, "elsewhere", row.elsewhere);
  add(json, "alias", row.alias);
  add(json, "excludes", row.excludes);
  add(json, "needs", row.needs);
  for (const auto& [key, holds] : {std::pair{"hidden", row.hidden},
                                   {"repeats", row.repeats},
                                   {"single", row.single},
                                   {"drawn", row.drawn}}) {
    if (holds) json[key] = true;
  }
  return json;
}

// Rows that are recorded under the same condition have the same "recorded", a number from 1.
Json fractureJson() {
  Json rows = Json::array();
  std::map<bool (*)(const RunOptions&), std::size_t> conditions;
  for (const FractureOptionRow& row : fractureOptionTable()) {
    rows.push_back(rowJson(row, RunOptions{}));
    if (row.recorded == nullptr) continue;
    rows.back()["recorded"] = conditions.emplace(row.recorded, conditions.size() + 1).first->second;
  }
  return rows;
}

Json datasetJson() {
  Json rows = Json::array();
  for (const DatasetOptionRow& row : datasetOptionTable()) {
    rows.push_back(rowJson(row, DatasetOptions{}));
  }
  return rows;
}

std::string rowsText(const Json& rows) {
  std::string text, group;
  for (const Json& row : rows) {
    if (row.contains("hidden")) continue;
    if (row.value("group", "") != group) text += "\n" + (group = row.value("group", "")) + "\n";
    text += "  --" + row["name"].get<std::string>();
    if (row.contains("choices")) {
      std::string choices;
      for (const Json& choice : row["choices"]) {
        choices += (choices.empty() ? "" : "|") + choice.get<std::string>();
      }
      if (row["type"] == "number") choices += "|" + row["range"].get<std::string>();
      text += " " + choices;
    } else if (row.contains("range")) {
      text += " " + row["range"].get<std::string>();
    }
    if (row.contains("unit")) text += " " + row["unit"].get<std::string>();
    if (row.contains("default") && row["type"] != "flag") {
      text += " [" + row["default"].get<std::string>() + "]";
    }
    text += ": " + row["help"].get<std::string>() + "\n";
  }
  return text;
}

}  // namespace

void addOptionsCommand(CLI::App& app, Action& run) {
  CLI::App* command =
      app.add_subcommand("options", "List the options of a fracture and of a dataset");
  auto json = std::make_shared<bool>(false);
  command->add_flag("--json", *json, "Print JSON: type, range, default, unit, help and more");
  command->callback([json, &run] {
    run = [json] {
      const Json all = {{"schema", "sherd-report/1"},
                        {"command", "options"},
                        {"fracture", fractureJson()},
                        {"dataset", datasetJson()}};
      printResult(*json ? all.dump(1) + "\n"
                        : "Of a fracture:\n" + rowsText(all["fracture"]) + "\nOf a dataset:\n" +
                              rowsText(all["dataset"]));
    };
  });
}

}  // namespace sherd::cli
