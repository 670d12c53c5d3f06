// What shapes a dataset, as text: "--erode-iterations=0..3 --resolution=64".
#include "dataset/identity.h"

#include <sherd/error.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "base/option_text.h"

namespace sherd {
namespace {

using Given = std::pair<std::string, std::string>;  // name and value

template <class Target>
void addRow(std::vector<Given>& given, const OptionRow<Target>& row, const Target& options,
            const Target& defaults) {
  const std::string text = row.value.text(options), usual = row.value.text(defaults);
  if (text == usual) return;
  if (!row.repeats) {
    given.emplace_back(row.name, text);
    return;
  }
  for (const std::string& one : split(text, ' ')) given.emplace_back(row.name, one);
}

DatasetOptions defaultsOf(DatasetLayout layout) {
  DatasetOptions defaults;
  if (layout == DatasetLayout::bb) defaults.each.write.meshFormats = {MeshFileFormat::obj};
  return defaults;
}

template <class Target>
bool sets(std::span<const OptionRow<Target>> rows, Target& options, const Given& given) {
  for (const OptionRow<Target>& row : rows) {
    if (row.hidden || row.name != given.first) continue;
    const bool isFlag = row.value.type == OptionType::flag;
    row.value.set(options, isFlag && given.second.empty() ? "true" : given.second);
    return true;
  }
  return false;
}

// Returns the options of an identity.
//   throws  Error(usage) an option or a value that does not exist
DatasetOptions optionsOf(const std::string& identity) {
  std::vector<Given> all;
  for (const std::string& part : split(identity, ' ')) {
    const std::size_t equals = part.find('=');
    if (part.starts_with("--")) {
      all.emplace_back(part.substr(2, equals == std::string::npos ? equals : equals - 2),
                       equals == std::string::npos ? "" : part.substr(equals + 1));
    }
  }
  DatasetOptions options;
  const auto first = [](const Given& given) {
    return given.first == "preset" || given.first == "layout";
  };
  std::stable_partition(all.begin(), all.end(), first);  // others override what these set
  for (const Given& given : all) {
    if (given.first == "layout") {
      (void)sets(datasetOptionTable(), options, given);
      options.each.write.meshFormats = defaultsOf(options.layout).each.write.meshFormats;
    } else if (auto drawn = drawnOption(given.first, given.second)) {
      options.drawn.push_back(std::move(*drawn));
    } else if (!sets(datasetOptionTable(), options, given) &&
               !sets(fractureOptionTable(), options.each, given)) {
      throw Error(ErrorCode::usage, given.first + " is not an option");
    }
  }
  return options;
}

}  // namespace

std::string datasetIdentity(const DatasetOptions& options) {
  std::vector<Given> given;
  const DatasetOptions defaults = defaultsOf(options.layout);
  for (const DatasetOptionRow& row : datasetOptionTable()) {
    if (*row.key != '\0') addRow(given, row, options, defaults);
  }
  for (const FractureOptionRow& row : fractureOptionTable()) {
    if (!row.hidden && !row.single) addRow(given, row, options.each, defaults.each);
  }
  for (const DrawnOption& option : options.drawn) given.emplace_back(option.name, option.text());
  std::stable_sort(given.begin(), given.end(),
                   [](const Given& a, const Given& b) { return a.first < b.first; });
  std::string text;
  for (const auto& [name, value] : given) {
    text += (text.empty() ? "--" : " --") + name + (value == "true" ? "" : "=" + value);
  }
  return text;
}

bool isIdentityOf(const DatasetOptions& options, const std::string& text) {
  const std::string own = datasetIdentity(options);
  if (text == own) return true;
  try {
    return datasetIdentity(optionsOf(text)) == own;
  } catch (const Error&) {
    return false;
  }
}

DatasetOptions laidOut(DatasetOptions options) {
  options.each.write.plainMeshes |= options.layout == DatasetLayout::bb;
  return options;
}

}  // namespace sherd
