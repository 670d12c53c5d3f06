// Files that are put in place together.
#include "io/held_files.h"

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

void HeldFiles::keep() {
  for (const std::unique_ptr<AtomicFile>& file : files_) file->keep();
  files_.clear();
}

}  // namespace sherd
