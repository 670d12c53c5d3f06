// Writes, reads and compares recipes.
#include "dataset/recipe/recipe.h"

#include <sherd/error.h>

#include <algorithm>
#include <set>
#include <utility>

#include "base/cancel_flag.h"
#include "base/files/parsed_json.h"
#include "base/files/sha256.h"
#include "base/input_error.h"
#include "base/text/option_text.h"
#include "base/text/printable.h"
#include "base/version.h"
#include "dataset/journal/failure.h"
#include "dataset/journal/json_fields.h"
#include "dataset/journal/plan.h"
#include "dataset/layouts/identity.h"

namespace sherd {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSchema = "sherd-recipe/1";
constexpr const char* kKind = "recipe of a dataset";
constexpr std::size_t kDigitsOfFracture = 8, kDigits = 64;

// A line for each file of a fracture, by name.
std::string linesOf(const Json& fracture) {
  std::set<std::pair<std::string, std::string>> files;
  for (const FileRecord& file : filesOf(fracture)) files.emplace(file.name, file.sha256);
  std::string lines;
  for (const auto& [name, sum] : files) lines += sum + "  " + name + "\n";
  return lines;
}

std::string textOf(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

// A list with an entry a line.
template <class Items, class Entry>
std::string listText(const Items& items, const Entry& entry) {
  std::string text = "[";
  for (const auto& item : items)
    text += (&item == &items.front() ? "\n" : ",\n") + textOf(entry(item));
  return text + "\n]";
}

std::string digits(const Json& object, const char* key, std::size_t count) {
  std::string text = fields::text(object, key);
  if (text.size() != count || text.find_first_not_of("0123456789abcdef") != std::string::npos)
    fields::damaged(std::string("\"") + key + "\" is no checksum");
  return text;
}

RecipeMesh meshOf(const Json& json) {
  if (!json.is_object()) fields::damaged("an entry of \"meshes\" is not an object");
  RecipeMesh mesh{.key = fields::text(json, "object"), .sha256 = {}, .license = {}};
  if (json.contains("sha256")) mesh.sha256 = digits(json, "sha256", kDigits);
  if (json.contains("license")) mesh.license = fields::text(json, "license");
  return mesh;
}

RecipeObject objectOf(const Json& json) {
  if (!json.is_object()) fields::damaged("an entry of \"objects\" is not an object");
  RecipeObject object{.key = fields::text(json, "object"),
                      .sha256 = digits(json, "sha256", kDigits),
                      .fractures = {}};
  for (const Json& one : fields::list(json, "fractures")) {
    if (!one.is_string() || one.get_ref<const std::string&>().size() != kDigitsOfFracture)
      fields::damaged("an entry of \"fractures\" is no checksum");
    object.fractures.push_back(one.get<std::string>());
  }
  return object;
}

// Requires keys that ascend, so that none is there twice.
template <class Entry>
void requireAscending(const std::vector<Entry>& all, const char* list) {
  const auto found = std::adjacent_find(
      all.begin(), all.end(), [](const Entry& a, const Entry& b) { return a.key >= b.key; });
  if (found == all.end()) return;
  fields::damaged(std::string("\"") + list + "\" is not ascending at " +
                  printable(std::next(found)->key));
}

DatasetRecipe recipeOf(const Json& json) {
  if (!json.is_object() || fields::text(json, "schema") != kSchema)
    fields::damaged("is of another schema");
  DatasetRecipe recipe{.program = fields::text(json, "program"),
                       .options = fields::text(json, "options"),
                       .drawn = {},
                       .meshes = {},
                       .objects = {}};
  for (const Json& name : fields::list(json, "drawn")) {
    if (!name.is_string()) fields::damaged("an entry of \"drawn\" is not text");
    recipe.drawn.push_back(name.get<std::string>());
  }
  for (const Json& mesh : fields::list(json, "meshes")) recipe.meshes.push_back(meshOf(mesh));
  for (const Json& object : fields::list(json, "objects"))
    recipe.objects.push_back(objectOf(object));
  requireAscending(recipe.meshes, "meshes");
  requireAscending(recipe.objects, "objects");
  if (recipe.meshes.empty()) fields::damaged("has no meshes");
  const bool areMeshes = std::includes(recipe.meshes.begin(), recipe.meshes.end(),
                                       recipe.objects.begin(), recipe.objects.end(),
                                       [](const auto& a, const auto& b) { return a.key < b.key; });
  if (!areMeshes) fields::damaged("\"objects\" has one that is not among \"meshes\"");
  return recipe;
}

const RecipeObject* objectWith(const DatasetRecipe& recipe, const std::string& key) {
  const auto found = std::lower_bound(
      recipe.objects.begin(), recipe.objects.end(), key,
      [](const RecipeObject& object, const std::string& name) { return object.key < name; });
  return found != recipe.objects.end() && found->key == key ? &*found : nullptr;
}

}  // namespace

void addObject(DatasetRecipe& recipe, const LibraryObject& object, const JournalText& journal) {
  recipe.meshes.push_back(
      {object.key, journal.failed ? journal.failed->sha256 : journal.sha256, object.license});
  if (!journal.done) return;
  RecipeObject made{object.key, {}, {}};
  Sha256 all;
  for (const Json& fracture : journal.fractures) {
    if (recipe.drawn.empty()) {
      for (const auto& [name, value] : fracture.at("options").items()) recipe.drawn.push_back(name);
    }
    const std::string lines = linesOf(fracture);
    all.add(lines);
    made.fractures.push_back(sha256(lines).substr(0, kDigitsOfFracture));
  }
  made.sha256 = all.text();
  recipe.objects.push_back(std::move(made));
}

std::string recipeText(const DatasetRecipe& recipe) {
  const std::string meshes = listText(recipe.meshes, [](const RecipeMesh& mesh) {
    Json json = {{"object", mesh.key}};
    if (!mesh.sha256.empty()) json["sha256"] = mesh.sha256;
    if (!mesh.license.empty()) json["license"] = mesh.license;
    return json;
  });
  const std::string objects = listText(recipe.objects, [](const RecipeObject& object) {
    return Json{{"object", object.key}, {"sha256", object.sha256}, {"fractures", object.fractures}};
  });
  return "{\n\"schema\": " + textOf(kSchema) + ",\n\"program\": " + textOf(recipe.program) +
         ",\n\"options\": " + textOf(recipe.options) + ",\n\"drawn\": " + textOf(recipe.drawn) +
         ",\n\"meshes\": " + meshes + ",\n\"objects\": " + objects + "\n}\n";
}

DatasetRecipe readRecipe(const fs::path& file) {
  const Json json = readOrderedJson(file, kKind, kLargestPlan);
  try {
    return recipeOf(json);
  } catch (const Error& e) {
    inputError(file, e.what());
  }
}

DatasetOptions optionsOfRecipe(const DatasetRecipe& recipe) {
  try {
    for (const std::string& part : split(recipe.options, ' ')) {
      if (part.starts_with("--")) continue;
      throw Error(ErrorCode::input, "\"options\" has " + printable(part) +
                                        ", which is no option; values with blanks can't be read");
    }
    DatasetOptions options = optionsOfIdentity(recipe.options);
    const auto place = [&](const DrawnOption& option) {
      return std::find(recipe.drawn.begin(), recipe.drawn.end(), option.name);
    };
    std::stable_sort(
        options.drawn.begin(), options.drawn.end(),
        [&](const DrawnOption& a, const DrawnOption& b) { return place(a) < place(b); });
    for (const RecipeMesh& mesh : recipe.meshes) {
      options.library.keys.insert(mesh.key);
      if (!mesh.license.empty()) options.library.licenses.push_back({mesh.key, mesh.license});
    }
    return options;
  } catch (const Error& e) {
    throw Error(ErrorCode::input, "the recipe is of sherd " + printable(recipe.program) +
                                      ", this is " SHERD_VERSION ": " + e.what());
  }
}

void requireMeshes(const fs::path& library, const DatasetRecipe& recipe, const Progress* progress) {
  LibraryOptions options;
  for (const RecipeMesh& mesh : recipe.meshes) options.keys.insert(mesh.key);
  const std::vector<LibraryObject> found = findObjects(library, options);
  for (std::size_t i = 0; i < found.size(); ++i) {  // as many, and in the same order
    throwIfCancelled(progress);
    const std::string& sum = recipe.meshes[i].sha256;
    if (sum.empty() || sumOfObject(found[i]) == sum) continue;
    inputError(found[i].file, "is another file than that of the recipe, whose SHA-256 is " + sum);
  }
}

std::vector<std::string> differences(const DatasetRecipe& asked, const DatasetRecipe& made) {
  std::vector<std::string> sentences;
  for (const RecipeMesh& mesh : asked.meshes) {
    const RecipeObject* const before = objectWith(asked, mesh.key);
    const RecipeObject* const now = objectWith(made, mesh.key);
    if (before == nullptr && now == nullptr) continue;
    if (before == nullptr || now == nullptr) {
      sentences.push_back(mesh.key +
                          (now == nullptr ? ": could not be broken, and could in "
                                          : ": could be broken, and could not in ") +
                          "the recipe's dataset");
      continue;
    }
    if (before->sha256 == now->sha256) continue;
    std::size_t other = 0;
    const std::size_t most = std::max(before->fractures.size(), now->fractures.size());
    for (std::size_t i = 0; i < most; ++i) {
      const bool isSame = i < before->fractures.size() && i < now->fractures.size() &&
                          before->fractures[i] == now->fractures[i];
      other += isSame ? 0 : 1;
    }
    sentences.push_back(mesh.key + ": " + std::to_string(other) + " of " + std::to_string(most) +
                        " fractures, the intact object counted, have other files");
  }
  return sentences;
}

}  // namespace sherd
