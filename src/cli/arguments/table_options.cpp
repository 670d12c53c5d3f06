// Command-line options from tables of options.
#include "cli/arguments/table_options.h"

#include <set>
#include <utility>

namespace sherd::cli {

void addFractureOptions(CLI::App& command, RunOptions& options) {
  for (const FractureOptionRow& row : fractureOptionTable()) {
    if (row.hidden) continue;
    const std::string alias = *row.alias != '\0' ? "--" + std::string(row.alias) + "," : "";
    addRow(command, alias + "--" + row.name, row, options,
           [&row, &options](const std::string& text) { row.value.set(options, text); });
  }
  addRelations(command, fractureOptionTable());
}

void addDatasetOptions(CLI::App& command, DatasetOptions& options) {
  for (const DatasetOptionRow& row : datasetOptionTable()) {
    addRow(command, "--" + std::string(row.name), row, options,
           [&row, &options](const std::string& text) { row.value.set(options, text); });
  }
  for (const FractureOptionRow& row : fractureOptionTable()) {
    if (row.hidden || row.single) continue;
    addRow(command, "--" + std::string(row.name), row, options.each,
           [&row, &options](const std::string& text) {
             if (auto drawn = drawnOption(row.name, text)) {
               options.drawn.push_back(std::move(*drawn));
             } else {
               row.value.set(options.each, text);
             }
           });
  }
  addRelations(command, fractureOptionTable());
}

void setGivenOptions(const CLI::App& command, RunOptions& options) {
  for (const FractureOptionRow& row : fractureOptionTable()) {  // presets and materials come first
    const CLI::Option* const option =
        row.hidden ? nullptr : command.get_option_no_throw("--" + std::string(row.name));
    if (option == nullptr || option->count() == 0) continue;
    const std::vector<std::string>& texts = option->results();
    const OptionType type = row.value.type;
    if (type == OptionType::flag) {
      row.value.set(options, "true");
    } else if (type == OptionType::choices || type == OptionType::wholes) {
      row.value.set(options, joinedText(texts, ","));
    } else if (row.repeats) {
      for (const std::string& text : texts) row.value.set(options, text);
    } else {
      row.value.set(options, texts.back());
    }
  }
}

OptionUse useOf(const CLI::App& command) {
  std::set<std::string, std::less<>> given;
  for (const CLI::Option* const option : command.get_options()) {
    if (option->count() > 0) given.insert(option->get_lnames().begin(), option->get_lnames().end());
  }
  return {.isGiven = [given](std::string_view name) { return given.contains(name); },
          .spelled = [](std::string_view name) { return "--" + std::string(name); }};
}

}  // namespace sherd::cli
