// Search for the nearest seed.
#pragma once

#include <sherd/seeds.h>

#include <cstdint>
#include <glm/ext/vector_int3_sized.hpp>
#include <vector>

namespace sherd {

/// Finds the nearest seed of a component: one k-d tree per component.  Orders are whole numbers
/// below 2^53, so without scales doubles are exact.
class NearestSeed {
 public:
  /// The point of a seed, in steps of any length.
  struct Site {
    glm::i64vec3 at;
    std::uint16_t fragment = 0;
    std::uint32_t component = 0;
    double scale = 1.0;  ///< divides metricOrder, > 0
  };

  ///   sites  of components below `components`
  NearestSeed(std::vector<Site> sites, std::size_t components, Metric metric);

  /// Returns the fragment of the nearest site in that component, which has one; ties go to the
  /// lower id.
  std::uint16_t fragmentAt(const glm::i64vec3& point, std::uint32_t component) const;

 private:
  struct Node {
    glm::i64vec3 min, max;              // tight box of its sites
    std::uint32_t first = 0, last = 0;  // its sites: [first, last)
    std::uint32_t right = 0;  // right child, 0 for a leaf; the left child is the next node
    double mostScale = 0.0;
  };
  struct Best;

  void build(std::uint32_t first, std::uint32_t last);
  void search(std::uint32_t node, const glm::i64vec3& point, Best& best) const;
  double leastOrder(std::uint32_t node, const glm::i64vec3& point) const;

  Metric metric_;
  std::vector<Site> sites_;  // grouped by component, then by node
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> root_;  // [component]
};

}  // namespace sherd
