// Joins fragments by their contacts.
#include "evaluate/cracks/contact_graph.h"

#include <algorithm>
#include <map>

#include "base/union_find.h"

namespace sherd {

ContactGraph contactGraph(std::span<const DividedMesh> meshes, std::span<const int> ids,
                          double leastArea) {
  std::map<int, std::size_t> indexOf;
  for (std::size_t i = 0; i < ids.size(); ++i) indexOf[ids[i]] = i;
  ContactGraph graph;
  UnionFind sets(ids.size());
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    for (const auto& [id, area] : meshes[i].neighborArea) {
      const auto other = indexOf.find(id);
      if (area < leastArea || other == indexOf.end() || other->second == i) continue;
      graph.contacts.push_back(std::minmax(i, other->second));
      sets.unite(static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(other->second));
    }
  }
  std::sort(graph.contacts.begin(), graph.contacts.end());
  graph.contacts.erase(std::unique(graph.contacts.begin(), graph.contacts.end()),
                       graph.contacts.end());
  std::map<std::uint32_t, std::size_t> numbers;
  for (std::uint32_t i = 0; i < ids.size(); ++i) {
    const auto [known, isNew] = numbers.try_emplace(sets.find(i), numbers.size());
    graph.object.push_back(known->second);
  }
  graph.objects = numbers.size();
  return graph;
}

std::optional<double> consecutiveExcess(const ContactGraph& graph, std::span<const int> ids) {
  const auto n = static_cast<double>(ids.size());
  std::vector<int> sorted(ids.begin(), ids.end());
  std::sort(sorted.begin(), sorted.end());
  double pairs = 0.0, touching = 0.0;
  for (std::size_t i = 1; i < sorted.size(); ++i) pairs += sorted[i] == sorted[i - 1] + 1;
  if (n < 3.0 || pairs == 0.0) return {};
  for (const auto& [a, b] : graph.contacts) touching += std::abs(ids[a] - ids[b]) == 1;
  return touching / pairs - static_cast<double>(graph.contacts.size()) / (0.5 * n * (n - 1.0));
}

}  // namespace sherd
