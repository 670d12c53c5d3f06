// What becomes of a folder's files when a fracture goes into it, and after a kill.
#include <gtest/gtest.h>
#include <sherd/error.h>
#include <sherd/folder.h>

#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>

#include "base/files/unfinished.h"
#include "folder/manifest/partial_folder.h"
#include "folder/manifest/read_manifest.h"
#include "temp_folder.h"

namespace sherd {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using Files = std::vector<std::string>;

void writeText(const fs::path& file, const std::string& text) {
  fs::create_directories(file.parent_path());
  std::ofstream(file) << text;
}

// Every file below a folder with its text, and every link; folders without.
std::map<std::string, std::string> contents(const fs::path& folder) {
  std::map<std::string, std::string> all;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    std::string& text = all[entry.path().lexically_relative(folder).string()];
    if (entry.is_symlink()) {
      text = "link to " + fs::read_symlink(entry.path()).string();
    } else if (entry.is_regular_file()) {
      std::ifstream in(entry.path());
      text.assign(std::istreambuf_iterator<char>(in), {});
    }
  }
  return all;
}

// A manifest of a fracture with these meshes, the first fragment's first.
std::string manifestOfMeshes(const Files& files) {
  Json json = {{"schema", kManifestSchema}, {"files", files}, {"fragments", Json::array()}};
  for (const std::string& file : files) {
    if (file.starts_with("meshes/")) json["fragments"].push_back({{"files", {{"mesh", file}}}});
  }
  return json.dump();
}

class FractureFolder : public TempFolder {
 protected:
  // A fracture of some meshes, each with this text.
  WrittenFolder write(const std::string& text, const Files& files) const {
    FractureReplacement replacement(out_, files);
    replacement.write([&](const fs::path& aside) {
      for (const std::string& file : files) writeText(aside / file, text);
      writeText(aside / kManifestName, manifestOfMeshes(files));
    });
    const Uncut whole;
    replacement.putInPlace();
    return {replacement.keep(), replacement.warnings()};
  }

  // As a run left them that was killed when the old one was aside and half of the new one moved.
  void halfReplaced() const {
    write("old", {"meshes/a_001.ply", "meshes/a_002.ply", "labels.rle"});
    whole_ = contents(out_);
    fs::create_directories(partial_ / "old" / "meshes");
    for (const char* file :
         {"manifest.json", "meshes/a_001.ply", "meshes/a_002.ply", "labels.rle"}) {
      fs::rename(out_ / file, partial_ / "old" / file);
    }
    writeText(partial_ / "new" / "manifest.json",
              manifestOfMeshes({"meshes/a_001.ply", "preview.png", "labels.rle"}));
    writeText(out_ / "meshes" / "a_001.ply", "new");
    writeText(partial_ / "new" / "preview.png", "new");
    fs::create_directory(partial_ / "new" / "meshes");
    writeText(partial_ / "new" / "labels.rle", "new");
  }

  std::string refusal() const {
    try {
      requireSettled(out_);
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::input);
      return e.what();
    }
    return "";
  }

  const fs::path out_ = folder_ / "out", partial_ = out_ / kPartialName;
  mutable std::map<std::string, std::string> whole_;
};

TEST_F(FractureFolder, KeepsFilesThatTheManifestListsAndNoFractureIsNamedSo) {
  write("old", {"meshes/a_001.ply", "labels.rle"});
  Json manifest = Json::parse(manifestOfMeshes({"meshes/a_001.ply", "labels.rle"}));
  for (const char* file : {"notes.txt", "meshes/mine.ply", "src/main.cpp", "gone.txt"}) {
    manifest["files"].push_back(file);
    if (std::string(file) != "gone.txt") writeText(out_ / file, "mine");
  }
  writeText(out_ / kManifestName, manifest.dump());
  const WrittenFolder written = write("new", {"meshes/a_001.ply"});
  EXPECT_EQ(contents(out_), (std::map<std::string, std::string>{
                                {"manifest.json", manifestOfMeshes({"meshes/a_001.ply"})},
                                {"meshes", ""},
                                {"meshes/a_001.ply", "new"},
                                {"meshes/mine.ply", "mine"},
                                {"notes.txt", "mine"},
                                {"src", ""},
                                {"src/main.cpp", "mine"}}));
  ASSERT_EQ(written.warnings.size(), 1u);
  EXPECT_EQ(written.warnings[0],
            out_.string() +
                ": the earlier manifest lists 'notes.txt', 'meshes/mine.ply', "
                "'src/main.cpp', which are not named as a fracture's files and stay");
}

// Version 0.1 moved all that the manifest lists.
TEST_F(FractureFolder, GetsBackFilesOfAnyName) {
  halfReplaced();
  writeText(partial_ / "old" / "notes.txt", "mine");
  writeText(partial_ / "old" / "src" / "more" / "main.cpp", "mine");
  EXPECT_EQ(refusal(), "");
  whole_.insert(
      {{"notes.txt", "mine"}, {"src", ""}, {"src/more", ""}, {"src/more/main.cpp", "mine"}});
  EXPECT_EQ(contents(out_), whole_);
}

TEST_F(FractureFolder, KeepsAsideWhatIsInTheWayOfAnother) {
  halfReplaced();
  writeText(partial_ / "old" / "notes.txt", "mine");
  writeText(out_ / "notes.txt", "another");
  EXPECT_NE(refusal().find("notes.txt"), std::string::npos);
  EXPECT_EQ(contents(partial_).at("old/notes.txt"), "mine");
  EXPECT_EQ(contents(out_).at("notes.txt"), "another");
  fs::remove(out_ / "notes.txt");
  EXPECT_EQ(refusal(), "");
  whole_["notes.txt"] = "mine";
  EXPECT_EQ(contents(out_), whole_);
}

TEST_F(FractureFolder, IsAsItWasWhereWhatIsInPlaceIsNotKept) {
  const auto passing = [&](const Files& files) {
    const Uncut whole;
    FractureReplacement replacement(out_, files);
    replacement.write([&](const fs::path& aside) {
      for (const std::string& file : files) writeText(aside / file, "new");
      writeText(aside / kManifestName, manifestOfMeshes(files));
    });
    replacement.putInPlace();
    EXPECT_EQ(contents(out_).at(files.front()), "new");
  };
  passing({"meshes/a_001.ply", "labels.rle"});
  EXPECT_FALSE(fs::exists(out_));
  write("old", {"meshes/a_001.ply", "vdb/a_001.vdb"});
  const auto before = contents(out_);
  passing({"labels.rle", "meshes/a_001.ply", "seeds.json"});
  EXPECT_EQ(contents(out_), before);
}

TEST_F(FractureFolder, IsNotReplacedWhereSuchAFileIsInTheWay) {
  write("old", {"meshes/a_001.ply"});
  Json manifest = Json::parse(manifestOfMeshes({"meshes/a_001.ply"}));
  manifest["files"].push_back("meshes/b_001.ply");
  writeText(out_ / kManifestName, manifest.dump());
  writeText(out_ / "meshes" / "b_001.ply", "mine");
  EXPECT_THROW((void)write("new", {"meshes/b_001.ply"}), Error);
  EXPECT_EQ(contents(out_)["meshes/b_001.ply"], "mine");
}

TEST_F(FractureFolder, IsPutBackBeforeItIsRead) {
  halfReplaced();
  requireSettled(out_);
  EXPECT_EQ(contents(out_), whole_);
  for (const char* path : {"manifest.json", "meshes", "."}) {
    fs::remove_all(out_);
    halfReplaced();
    requireSettled(out_ / path);
    EXPECT_EQ(contents(out_), whole_) << path;
  }
}

TEST_F(FractureFolder, IsPutBackBeforeItIsReplaced) {
  halfReplaced();
  checkFractureFolder(out_);
  EXPECT_EQ(contents(out_), whole_);
}

TEST_F(FractureFolder, LosesNoFileThatSomebodyPutInItsWay) {
  halfReplaced();
  writeText(out_ / "labels.rle", "mine");  // the new one is not moved yet, the old one is aside
  const auto before = contents(out_);
  EXPECT_NE(refusal().find("labels.rle: cannot be put in place: file exists"), std::string::npos)
      << refusal();
  EXPECT_THROW(checkFractureFolder(out_), Error);
  EXPECT_EQ(contents(out_)["labels.rle"], "mine");
  fs::remove(out_ / "labels.rle");
  requireSettled(out_);
  EXPECT_EQ(contents(out_), whole_);
}

TEST_F(FractureFolder, IsLeftAloneWhileAnotherHoldsIt) {
  halfReplaced();
  {
    fs::rename(partial_, folder_ / "kept");
    const PartialFolder held(out_);
    EXPECT_NE(refusal().find("another sherd is writing there"), std::string::npos);
    EXPECT_THROW(checkFractureFolder(out_), Error);
  }
  fs::rename(folder_ / "kept", partial_);
  requireSettled(out_);
  EXPECT_EQ(contents(out_), whole_);
}

TEST_F(FractureFolder, IsNoFractureWhereTheFirstRunWasKilled) {
  writeText(partial_ / "new" / "manifest.json",
            manifestOfMeshes({"meshes/a_001.ply", "seeds.json"}));
  writeText(partial_ / "new" / "seeds.json", "new");
  fs::create_directories(partial_ / "new" / "meshes");
  fs::create_directories(partial_ / "made" / "meshes");
  writeText(out_ / "meshes" / "a_001.ply", "new");
  EXPECT_NE(refusal().find("holds no finished fracture"), std::string::npos);
  checkFractureFolder(out_);
  EXPECT_TRUE(fs::is_empty(out_));
}

TEST_F(FractureFolder, TakesHostileLeftoversForWhatTheyAre) {
  // Manifests of strangers: files of others, links, files that are not there, no manifest at all.
  writeText(folder_ / "elsewhere" / "a_001.ply", "mine");
  writeText(folder_ / "elsewhere" / "manifest.json", manifestOfMeshes({"meshes/a_001.ply"}));
  const auto prepare = [&] {
    fs::remove_all(out_);
    writeText(out_ / "notes.txt", "mine");
    writeText(out_ / "src" / "main.cpp", "mine");
    fs::create_directories(partial_);
  };
  const auto undone = [&] {
    try {
      checkFractureFolder(out_);
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::output);
    }
    const auto now = contents(out_);
    EXPECT_EQ(now.at("notes.txt"), "mine");
    EXPECT_EQ(now.at("src/main.cpp"), "mine");
    EXPECT_EQ(contents(folder_ / "elsewhere").at("a_001.ply"), "mine");
    EXPECT_EQ(contents(folder_ / "elsewhere").size(), 2u);
  };
  for (const char* side : {"new", "old"}) {
    prepare();
    writeText(partial_ / side / "manifest.json",
              manifestOfMeshes({"notes.txt", "src/main.cpp", "meshes/a_001.ply"}));
    undone();
    prepare();
    writeText(partial_ / side / "manifest.json", manifestOfMeshes({"../elsewhere/a_001.ply"}));
    undone();
    EXPECT_TRUE(fs::exists(partial_ / side / "manifest.json"));
    prepare();
    writeText(partial_ / side / "manifest.json", "{}");
    undone();
    prepare();
    fs::create_directory_symlink(folder_ / "elsewhere", partial_ / side);
    undone();
    prepare();
    writeText(partial_ / side / "manifest.json", manifestOfMeshes({"meshes/a_001.ply"}));
    fs::create_directory_symlink(folder_ / "elsewhere", partial_ / side / "meshes");
    undone();
    prepare();
    writeText(partial_ / side / "manifest.json", manifestOfMeshes({"meshes/a_001.ply"}));
    fs::create_directory_symlink(folder_ / "elsewhere", out_ / "meshes");
    undone();
    prepare();
    fs::create_directory_symlink(folder_ / "elsewhere", out_ / "old");
    fs::create_symlink(folder_ / "elsewhere" / "manifest.json", partial_ / "manifest.json");
    undone();
  }
  prepare();
  fs::remove(partial_);
  fs::create_directory_symlink(folder_ / "elsewhere", partial_);
  undone();
  prepare();
  fs::remove(partial_);
  writeText(partial_, "mine");
  undone();
  EXPECT_EQ(contents(out_).at(kPartialName), "mine");
}

}  // namespace
}  // namespace sherd
