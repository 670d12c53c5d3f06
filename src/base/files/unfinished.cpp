// The registry of temporary files and processes.
#include "base/files/unfinished.h"

#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <csignal>
#include <exception>
#include <map>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>

namespace sherd {
namespace {

namespace fs = std::filesystem;

struct Entry {
  fs::path path;
  Unfinished::Kind kind{};
  pid_t process = 0;
};

// Never destroyed: threads may outlive main().
struct Registry {
  std::mutex mutex;
  std::condition_variable changed;
  int uncut = 0;  // threads within an Uncut
  bool ended = false;
  unsigned long last = 0;
  std::map<unsigned long, Entry> entries;  // by number, in the order of creation
};

Registry& registry() {
  static auto* const all = new Registry;
  return *all;
}

thread_local int depth = 0;  // of nested Uncuts

unsigned long add(Entry entry) {
  Registry& all = registry();
  const std::lock_guard lock(all.mutex);
  all.entries.emplace(++all.last, std::move(entry));
  return all.last;
}

void remove(const Entry& entry) {
  constexpr int kTries = 300;  // a thread may create a file while the folder is emptied
  constexpr std::chrono::milliseconds kBetween(10);
  std::error_code ignored;
  if (entry.process > 0) {
    ::kill(entry.process, SIGKILL);
  } else if (entry.kind == Unfinished::Kind::folder) {
    for (int i = 0; i < kTries; ++i) {
      fs::remove_all(entry.path, ignored);
      if (!fs::exists(fs::symlink_status(entry.path, ignored))) return;
      std::this_thread::sleep_for(kBetween);
    }
  } else if (entry.kind == Unfinished::Kind::madeFolder) {
    ::rmdir(entry.path.c_str());
  } else {
    ::unlink(entry.path.c_str());
  }
}

}  // namespace

Uncut::Uncut() {
  if (depth++ > 0) return;
  Registry& all = registry();
  std::unique_lock lock(all.mutex);
  all.changed.wait(lock, [&] { return !all.ended; });
  ++all.uncut;
}

Uncut::~Uncut() {
  if (--depth > 0) return;
  Registry& all = registry();
  {
    const std::lock_guard lock(all.mutex);
    --all.uncut;
  }
  all.changed.notify_all();
}

Unfinished::Unfinished(fs::path path, Kind kind) : number_(add({std::move(path), kind, 0})) {}

Unfinished::Unfinished(pid_t process) : number_(add({{}, {}, process})) {}

Unfinished::Unfinished(Unfinished&& other) noexcept : number_(std::exchange(other.number_, 0)) {}

Unfinished& Unfinished::operator=(Unfinished&& other) noexcept {
  std::swap(number_, other.number_);
  return *this;
}

void Unfinished::end() {
  if (number_ == 0) return;
  Registry& all = registry();
  const std::lock_guard lock(all.mutex);
  all.entries.erase(std::exchange(number_, 0));
}

void endAllWork() {
  Registry& all = registry();
  std::unique_lock lock(all.mutex);
  all.ended = true;
  all.changed.wait(lock, [&] { return all.uncut == 0; });
}

void removeUnfinished() {
  Registry& all = registry();
  const std::lock_guard lock(all.mutex);  // held until the process ends, so no copy is needed
  for (auto entry = all.entries.rbegin(); entry != all.entries.rend(); ++entry) {
    try {
      remove(entry->second);
    } catch (const std::exception&) {
      // Out of memory for this entry; the next may succeed.
    }
  }
}

}  // namespace sherd
