// Files that are put in place together.
#include "cli/terminal/held_files.h"

#include <utility>

namespace sherd {

void HeldFiles::take(const std::string& name, const Content& content) {
  auto file = std::make_unique<AtomicFile>(name);
  content([&](std::string_view bytes) { file->write(bytes); });
  file->close();
  const std::lock_guard lock(mutex_);
  files_.push_back(std::move(file));
}

void HeldFiles::putInPlace() {
  for (const std::unique_ptr<AtomicFile>& file : files_) file->putInPlace();
}

// In reverse order: of two files with one name, the later one replaced the earlier one.
std::string HeldFiles::drop() {
  std::string left;
  for (; !files_.empty(); files_.pop_back()) {
    const std::string one = files_.back()->takeBack();
    if (!one.empty()) left += (left.empty() ? "" : "; ") + one;
  }
  return left;
}

HeldFiles::~HeldFiles() {
  while (!files_.empty()) files_.pop_back();
}

void HeldFiles::keep() {
  for (const std::unique_ptr<AtomicFile>& file : files_) file->keep();
  files_.clear();
}

}  // namespace sherd
