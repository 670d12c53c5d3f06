// Writes and reads dataset.json.
#include "dataset/journal/plan.h"

#include <sherd/error.h>

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>

#include "base/files/atomic_file.h"
#include "base/files/below_folder.h"
#include "base/files/parsed_json.h"
#include "base/input_error.h"
#include "base/text/option_names.h"
#include "dataset/journal/json_fields.h"
#include "dataset/journal/object_folder.h"

namespace sherd {
namespace {

namespace fs = std::filesystem;

constexpr const char* kKind = "dataset.json of a dataset";
constexpr const char* kSchema = "sherd-dataset/1";
constexpr std::uint64_t kLargestShare = 1'000'000;

DatasetLayout layoutOf(const std::string& name) {
  const auto* const found =
      std::find(std::begin(names::kDatasetLayout), std::end(names::kDatasetLayout), name);
  if (found == std::end(names::kDatasetLayout)) fields::damaged("has an unknown layout");
  return static_cast<DatasetLayout>(found - std::begin(names::kDatasetLayout));
}

std::array<int, 3> splitOf(const Json& shares) {
  std::array<int, 3> split{};
  if (shares.size() != split.size()) fields::damaged("\"split\" is not a list of three shares");
  std::transform(shares.begin(), shares.end(), split.begin(), [](const Json& share) {
    if (!share.is_number_unsigned() || share > kLargestShare) {
      fields::damaged("\"split\" is out of range: " + share.dump());
    }
    return share.get<int>();
  });
  return split;
}

LibraryObject objectOf(const Json& json) {
  if (!json.is_object()) fields::damaged("an entry of \"objects\" is not an object");
  LibraryObject object{.key = fields::text(json, "key"),
                       .folder = fields::text(json, "folder"),
                       .file = {},
                       .bytes = fields::count(json, "bytes")};
  if (json.contains("license")) object.license = fields::text(json, "license");
  if (json.contains("parts")) {
    for (const Json& key : fields::list(json, "parts")) {
      if (!key.is_string()) fields::damaged("an entry of \"parts\" is not text");
      object.parts.push_back({.key = key, .folder = {}, .file = {}});
    }
    object.intruders = fields::count(json, "intruders", 0, object.parts.size());
  }
  if (!isBelowFolder(object.folder)) {
    fields::damaged("puts an object into '" + object.folder +
                    "', which leaves the dataset's folder");
  }
  return object;
}

DatasetPlan planOf(const Json& json) {
  if (!json.is_object() || fields::text(json, "schema") != kSchema)
    fields::damaged("is of another schema");
  DatasetPlan plan{.text = fields::text(json, "options"),
                   .objects = {},
                   .layout = layoutOf(fields::text(json, "layout")),
                   .split = splitOf(fields::list(json, "split")),
                   .seed = fields::count(json, "seed")};
  for (const Json& object : fields::list(json, "objects")) plan.objects.push_back(objectOf(object));
  return plan;
}

}  // namespace

bool hasPlan(const fs::path& out) { return fs::exists(out / kPlanName); }

std::string planText(const DatasetPlan& plan) {
  Json objects = Json::array();
  for (const LibraryObject& object : plan.objects) {
    objects.push_back({{"key", object.key}, {"folder", object.folder}, {"bytes", object.bytes}});
    Json& own = objects.back();
    if (!object.license.empty()) own["license"] = object.license;
    if (object.parts.empty()) continue;
    own["parts"] = Json::array();
    for (const LibraryObject& part : object.parts) own["parts"].push_back(part.key);
    own["intruders"] = object.intruders;
  }
  const Json json = {
      {"schema", kSchema},    {"layout", names::of(names::kDatasetLayout, plan.layout)},
      {"seed", plan.seed},    {"split", plan.split},
      {"options", plan.text}, {"objects", std::move(objects)}};
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

void writePlan(const fs::path& out, const DatasetPlan& plan) {
  writeWhole(out / kPlanName, planText(plan));
}

DatasetPlan parsedPlan(std::string_view text) { return planOf(parsedOrderedJson(text)); }

DatasetPlan readPlan(const fs::path& out) {
  const fs::path file = out / kPlanName;
  if (!isOwnFile(out, kPlanName)) inputError(out, "is no dataset: it has no file dataset.json");
  const Json json = readOrderedJson(file, kKind, kLargestPlan);
  try {
    return planOf(json);
  } catch (const Error& e) {
    inputError(file, std::string("is damaged: ") + e.what(), e.options());
  }
}

}  // namespace sherd
