// Decides whether the neighbors of a folder's meshes are those of its files.
#include "folder/read/recorded_neighbors.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "mesh/triangle_area.h"

namespace sherd {
namespace {

constexpr double kMostDifference = 0.2;  // of the areas of both sides
constexpr int kMostId = 65534;
constexpr std::size_t kMostDigits = 5;

/// Areas towards each neighbor, [fragments].
using Contacts = std::vector<std::map<int, double>>;

Contacts contactsOf(const FragmentSet& set) {
  Contacts contacts(set.fragments.size());
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const TriangleMesh& mesh = set.fragments[i].mesh.mesh;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      if (mesh.neighbor[t] == 0) continue;
      contacts[i][mesh.neighbor[t]] += areaOf(positionsOf(mesh.vertices, mesh.triangles[t]));
    }
  }
  return contacts;
}

/// The number at the end of a file's name without its extension, 0 if it is no id.
int idInName(const std::string& name) {
  const std::string stem = std::filesystem::path(name).stem().string();
  const std::size_t before = stem.find_last_not_of("0123456789");
  const std::string digits = stem.substr(before == std::string::npos ? 0 : before + 1);
  if (digits.empty() || digits.size() > kMostDigits) return 0;
  const int number = std::stoi(digits);
  return number <= kMostId ? number : 0;
}

std::vector<int> idsOfNames(const FragmentSet& set) {
  std::vector<int> ids;
  for (const EvaluatedFragment& fragment : set.fragments) ids.push_back(idInName(fragment.name));
  const std::set<int> different(ids.begin(), ids.end());
  if (different.size() < ids.size() || different.contains(0)) return {};
  return ids;
}

/// Returns whether contacts agree if these are the ids of their fragments.
///   needsContacts  whether two fragments of the set have to touch
bool agree(const Contacts& contacts, const std::vector<int>& ids, bool needsContacts) {
  std::map<int, std::size_t> indexOf;
  for (std::size_t i = 0; i < ids.size(); ++i) indexOf[ids[i]] = i;
  bool isAny = false;
  double apart = 0.0, all = 0.0;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    for (const auto& [id, area] : contacts[i]) {
      if (id == ids[i]) return false;
      isAny = true;
      const auto other = indexOf.find(id);
      if (other == indexOf.end()) continue;
      const auto back = contacts[other->second].find(ids[i]);
      apart += std::abs(area - (back == contacts[other->second].end() ? 0.0 : back->second));
      all += area;
    }
  }
  return isAny && (all > 0.0 || !needsContacts) && apart <= kMostDifference * all;
}

}  // namespace

void keepAgreeingNeighbors(FragmentSet& set) {
  const auto hasNeighbors = [](const EvaluatedFragment& fragment) {
    return !fragment.mesh.mesh.neighbor.empty();
  };
  if (std::all_of(set.fragments.begin(), set.fragments.end(), hasNeighbors)) {
    const Contacts contacts = contactsOf(set);
    std::vector<int> places;
    for (const EvaluatedFragment& fragment : set.fragments) places.push_back(fragment.mesh.id);
    const std::vector<int> numbers = idsOfNames(set);
    if (!numbers.empty() && agree(contacts, numbers, /*needsContacts=*/false)) {
      for (std::size_t i = 0; i < numbers.size(); ++i) set.fragments[i].mesh.id = numbers[i];
      return;
    }
    if (agree(contacts, places, /*needsContacts=*/true)) return;
  }
  for (EvaluatedFragment& fragment : set.fragments) fragment.mesh.mesh.neighbor.clear();
}

}  // namespace sherd
