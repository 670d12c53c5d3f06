// Arrays and texts in untrusted bytes.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "base/memory_budget.h"

namespace sherd {

/// Reads arrays and texts from the front of bytes that need not be trusted.  Each is its length in
/// 8 bytes, then its elements as in memory.  good() is false once one was cut short, and nothing is
/// read from then on.
class ByteSource {
 public:
  static constexpr std::size_t kCountBytes = sizeof(std::uint64_t);  ///< of an array's length

  ///   memory  charged with lists of texts beyond their bytes here; null: nothing is charged
  explicit ByteSource(std::string_view bytes, MemoryBudget* memory = nullptr)
      : bytes_(bytes), memory_(memory) {}
  [[nodiscard]] bool good() const { return good_; }
  [[nodiscard]] bool isAt(std::string_view end) const { return good_ && bytes_ == end; }

  std::uint64_t takeCount() {
    std::uint64_t count = 0;
    good_ = good_ && bytes_.size() >= sizeof count;
    if (!good_) return 0;
    std::memcpy(&count, bytes_.data(), sizeof count);
    bytes_.remove_prefix(sizeof count);
    return count;
  }

  template <class Element>
  void take(std::vector<Element>& elements) {
    static_assert(std::is_trivially_copyable_v<Element>);
    const std::uint64_t count = takeCount();
    good_ = good_ && count <= bytes_.size() / sizeof(Element);
    if (!good_) return;
    elements.resize(count);
    if (count > 0) std::memcpy(elements.data(), bytes_.data(), count * sizeof(Element));
    bytes_.remove_prefix(count * sizeof(Element));
  }

  void take(std::string& text) {
    const std::uint64_t count = takeCount();
    good_ = good_ && count <= bytes_.size();
    if (!good_) return;
    text.assign(bytes_.substr(0, count));
    bytes_.remove_prefix(count);
  }

  /// Reads an array that has one element.
  template <class Element>
  void takeOne(Element& element) {
    std::vector<Element> elements;
    take(elements);
    good_ = good_ && elements.size() == 1;
    if (good_) element = elements[0];
  }

  /// Reads an array that has one element, the number of elements that follow, and allocates these.
  ///   leastBytes  of an element here; it may take more in memory
  template <class Element>
  void makeRoom(std::vector<Element>& elements, std::size_t leastBytes) {
    std::uint64_t number = 0;
    takeOne(number);
    good_ = good_ && number <= bytes_.size() / leastBytes;
    if (!good_) return;
    if (memory_ != nullptr) memory_->charge(number, sizeof(Element));
    elements.resize(number);
  }

  void take(std::vector<std::string>& texts) {
    makeRoom(texts, kCountBytes);
    for (std::string& text : texts) take(text);
  }

 private:
  std::string_view bytes_;
  MemoryBudget* memory_;
  bool good_ = true;
};

}  // namespace sherd
