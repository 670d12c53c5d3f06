// The points on contacts, contact by contact.
#pragma once

#include <sherd/points.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "points/blocks.h"

namespace sherd {

/// The contacts of which correspondences are sampled.  Keeps a reference to the fragments.
class ContactSequence {
 public:
  ///   as sampleCorrespondences
  ContactSequence(std::span<const Fragment> fragments, std::size_t countPerContact,
                  std::uint64_t seed);

  /// Returns the number of contacts that have points.
  [[nodiscard]] std::size_t contacts() const { return contacts_.size(); }
  [[nodiscard]] std::size_t countPerContact() const { return countPerContact_; }

  /// A block has points of one contact.  Keeps a reference to this.
  [[nodiscard]] Blocks<Correspondences> blocks() const;

 private:
  struct Pair {
    std::size_t fragment = 0;  // index
    int neighbor = 0;          // id
  };

  void visitContact(const Pair& pair,
                    const std::function<void(const Correspondences&)>& visit) const;

  std::span<const Fragment> fragments_;
  std::size_t countPerContact_;
  std::uint64_t seed_;
  std::vector<Pair> contacts_;
};

}  // namespace sherd
