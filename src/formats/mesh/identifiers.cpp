// Names of prims, attributes and groups.
#include "formats/mesh/identifiers.h"

#include <set>
#include <utility>

namespace sherd {
namespace {

bool isLetter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool isDigit(char c) { return c >= '0' && c <= '9'; }

}  // namespace

std::string identifierOf(std::string_view text) {
  std::string name;
  for (const char c : text) name += isLetter(c) || isDigit(c) ? c : '_';
  return name.empty() || isDigit(name.front()) ? "_" + name : name;
}

std::vector<std::string> identifiersOf(const MaterialTable& table) {
  std::vector<std::string> names;
  std::set<std::string> taken;
  for (const MaterialTable::Entry& entry : table.materials) {
    const std::string name = identifierOf(entry.name);
    std::string unique = name;
    for (int i = 2; !taken.insert(unique).second; ++i) unique = name + "_" + std::to_string(i);
    names.push_back(std::move(unique));
  }
  return names;
}

}  // namespace sherd
