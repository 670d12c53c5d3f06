// Makes the recipe of a dataset.
#pragma once

#include <sherd/dataset.h>

#include <string>

#include "dataset/journal/journal.h"

namespace sherd {

/// Adds what came out of an object, unless it failed.
void addObject(DatasetRecipe& recipe, const LibraryObject& object, const JournalText& journal);

/// Returns the text of recipe.json: a mesh and an object a line.
[[nodiscard]] std::string recipeText(const DatasetRecipe& recipe);

}  // namespace sherd
