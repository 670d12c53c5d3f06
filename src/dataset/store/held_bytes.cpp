// The bytes of a file that is not stored yet: in memory, or in a temporary file if it is large.
#include "dataset/store/held_bytes.h"

#include <sherd/error.h>

#include <fstream>
#include <string>
#include <system_error>

#include "base/files/unfinished.h"

namespace sherd {

void HeldBytes::append(std::string_view bytes) {
  size_ += bytes.size();
  if (isInMemory() && size_ > kMost) moveToFile();
  if (temporary_) return temporary_->write(bytes);
  bytes_.append(bytes);
}

void HeldBytes::moveToFile() {
  if (!isInMemory()) return;
  {
    const Uncut whole;
    std::error_code failed;
    std::filesystem::create_directories(file_.parent_path(), failed);  // a failure shows below
  }
  temporary_ = std::make_unique<AtomicFile>(file_, Caching::none);
  temporary_->write(bytes_.pieces());
  bytes_.clear();
}

void HeldBytes::forEach(const std::function<void(std::string_view)>& visit) const {
  if (isInMemory()) {
    for (const std::string_view piece : bytes_.pieces()) visit(piece);
    return;
  }
  std::ifstream in(temporary_->temporary(), std::ios::binary);
  std::string block(BlockPool::kBytes, '\0');
  std::uint64_t left = size_;
  while (left > 0 && in) {
    in.read(block.data(), static_cast<std::streamsize>(block.size()));
    const auto some = static_cast<std::size_t>(in.gcount());
    visit(std::string_view(block).substr(0, some));
    left -= std::min<std::uint64_t>(left, some);
  }
  if (left > 0) {
    throw Error(ErrorCode::output, temporary_->temporary().string() + ": cannot be read again");
  }
}

void HeldBytes::clear() {
  bytes_.clear();
  temporary_.reset();
}

}  // namespace sherd
