#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>

namespace sherd {

/// The content of a file.
inline std::string bytesOf(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Copy every manifest below a folder into $SHERD_TEST_MANIFESTS, if set, where
/// tests/cli/unit_manifests_test.py checks them.
inline void keepManifests(const std::filesystem::path& folder) {
  const char* const kept = std::getenv("SHERD_TEST_MANIFESTS");
  if (kept == nullptr) return;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.path().filename() != "manifest.json") continue;
    std::string name = std::string(kept) + "/XXXXXX.json";
    const int file = mkstemps(name.data(), 5);
    if (file < 0) throw std::runtime_error("a manifest cannot be kept");
    close(file);
    std::filesystem::copy_file(entry.path(), name,
                               std::filesystem::copy_options::overwrite_existing);
  }
}

/// A folder of its own, which goes with it.
class OwnFolder {
 public:
  OwnFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "sherd-test-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
    path_ = name;
  }
  ~OwnFolder() {
    keepManifests(path_);
    std::filesystem::remove_all(path_);
  }
  OwnFolder(const OwnFolder&) = delete;
  OwnFolder& operator=(const OwnFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// A fixture with a folder of its own.
class TempFolder : public testing::Test {
 private:
  OwnFolder own_;

 protected:
  const std::filesystem::path folder_ = own_.path();
};

}  // namespace sherd
