// Readers against any bytes: each file is read or refused with an Error(input), and nothing else
// happens.
//
//   SHERD_FUZZ=list      print the names of the targets
//   SHERD_FUZZ=corpus    write the files that they begin with below the folder SHERD_FUZZ_CORPUS
//   SHERD_FUZZ=NAME      with libFuzzer: fuzz the reader of this name
//
// Without libFuzzer (GCC has none) all targets read these files, and each changed by a seeded
// generator.
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>

#include "fuzz/targets.h"

namespace {

std::string setting(const char* name) {
  const char* const value = std::getenv(name);
  return value ? value : "";
}

// Do what is asked for beside fuzzing; false where nothing is.
bool answered() {
  const std::string wanted = setting("SHERD_FUZZ");
  if (wanted == "corpus") sherd::fuzz::writeCorpus(setting("SHERD_FUZZ_CORPUS"));
  for (const sherd::fuzz::Target& target : sherd::fuzz::targets()) {
    if (wanted == "list") std::puts(target.name);
  }
  return wanted == "corpus" || wanted == "list";
}

}  // namespace

#ifndef SHERD_FUZZ_STANDALONE

namespace {

const sherd::fuzz::Target* chosen = nullptr;

}  // namespace

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  if (answered()) std::exit(0);
  for (const sherd::fuzz::Target& target : sherd::fuzz::targets()) {
    if (setting("SHERD_FUZZ") == target.name) chosen = &target;
  }
  if (chosen != nullptr) return 0;
  std::fputs("SHERD_FUZZ names no target (try list)\n", stderr);
  std::exit(2);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  sherd::fuzz::readOrRefuse(*chosen, {reinterpret_cast<const char*>(data), size});
  return 0;
}

#else

namespace {

std::string changed(std::string bytes, std::minstd_rand& random) {
  for (unsigned edits = random() % 4; edits > 0 && !bytes.empty(); --edits) {
    const std::size_t at = random() % bytes.size();
    switch (random() % 4) {
      case 0:
        bytes[at] = static_cast<char>(random());
        break;
      case 1:
        bytes.resize(at + 1);
        break;
      case 2:
        bytes.insert(at, bytes.substr(at, random() % 20));
        break;
      default:
        bytes[at] = "0123456789-.e \n"[random() % 15];
        break;
    }
  }
  return bytes;
}

}  // namespace

int main() {
  if (answered()) return 0;
  const auto files = sherd::fuzz::startingFiles();
  std::minstd_rand random(17);
  constexpr std::size_t kRounds = 300;
  for (std::size_t i = 0; i < files.size(); ++i) {
    for (const std::string& file : files[i]) {
      sherd::fuzz::readOrRefuse(sherd::fuzz::targets()[i], file);
    }
    for (std::size_t round = 0; round < kRounds; ++round) {
      const std::string& file = files[i][round % files[i].size()];
      sherd::fuzz::readOrRefuse(sherd::fuzz::targets()[i], changed(file, random));
    }
  }
  std::printf("%zu files read or refused\n", kRounds * files.size());
}

#endif
