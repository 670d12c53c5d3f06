// Recipes beside a library.
#include <gtest/gtest.h>
#include <sherd/dataset.h>

#include <fstream>
#include <string>

#include "base/files/sha256.h"
#include "temp_folder.h"

namespace sherd {
namespace {

TEST(Recipes, ReadingMeshesEndsWhenCancelled) {
  const OwnFolder library;
  DatasetRecipe recipe;
  for (const std::string name : {"a.obj", "b.obj", "c.obj"}) {
    std::ofstream(library.path() / name) << name;
    recipe.meshes.push_back({name, sha256(name), {}});
  }
  requireMeshes(library.path(), recipe);
  int asked = 0;
  const Progress progress{.report = {}, .cancelled = [&] { return ++asked == 2; }};
  try {
    requireMeshes(library.path(), recipe, &progress);
    FAIL() << "it goes on";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::cancelled);
  }
  EXPECT_EQ(asked, 2);
}

}  // namespace
}  // namespace sherd
