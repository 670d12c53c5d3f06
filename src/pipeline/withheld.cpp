// Withholds fragments one after another.
#include "pipeline/withheld.h"

#include <algorithm>

namespace sherd {
namespace {

class Withholding {
 public:
  Withholding(std::size_t fragments, std::size_t count, std::span<const CrackArea> contacts)
      : left_(count),
        neighbors_(fragments + 1),
        touching_(fragments + 1, 0),
        withheld_(fragments + 1, false) {
    for (const CrackArea& contact : contacts) {
      if (contact.a < 1 || contact.b < 1 || contact.a > fragments || contact.b > fragments)
        continue;
      neighbors_[contact.a].push_back(contact.b);
      neighbors_[contact.b].push_back(contact.a);
    }
    for (std::size_t id = 1; id <= fragments; ++id) touching_[id] = neighbors_[id].size();
  }

  std::vector<bool> run() {
    for (std::size_t id = last(); id > 0 && left_ > 0; --id) {
      if (neighbors_[id].empty()) withhold(id);
    }
    withholdFree();
    withholdPairs();
    while (left_ > 0) withholdAny();
    return std::move(withheld_);
  }

 private:
  std::size_t last() const { return neighbors_.size() - 1; }

  // Withholds fragments without which no other is alone, as long as there are any.
  void withholdFree() {
    for (std::size_t before = left_ + 1; before != left_ && left_ > 0;) {
      before = left_;
      for (std::size_t id = last(); id > 0 && left_ > 0; --id) {
        if (mayGo(id)) withhold(id);
      }
    }
  }

  bool mayGo(std::size_t id) const {
    return !withheld_[id] &&
           std::all_of(neighbors_[id].begin(), neighbors_[id].end(),
                       [&](std::size_t n) { return withheld_[n] || touching_[n] > 1; });
  }

  void withhold(std::size_t id) {
    withheld_[id] = true;
    --left_;
    for (const std::size_t n : neighbors_[id]) --touching_[n];
  }

  void restore(std::size_t id) {
    withheld_[id] = false;
    ++left_;
    for (const std::size_t n : neighbors_[id]) ++touching_[n];
  }

  // Returns the kept neighbor of one of a pair; 0 if there is none.
  std::size_t partnerOf(std::size_t id) const {
    const auto found = std::find_if(neighbors_[id].begin(), neighbors_[id].end(),
                                    [&](std::size_t n) { return !withheld_[n]; });
    return found == neighbors_[id].end() ? 0 : *found;
  }

  // Withholds pairs, where nothing else is left.  If one fragment too many would be withheld by
  // that, one that was withheld before and touches a pair returns, and that pair stays.
  void withholdPairs() {
    const std::size_t returned = left_ % 2 == 1 ? lastBesidePair() : 0;
    const std::size_t beside = returned == 0 ? 0 : partnerOf(returned);
    std::size_t pairs = (left_ + (returned == 0 ? 0 : 1)) / 2;
    for (std::size_t id = last(); id > 0 && pairs > 0; --id) {
      if (withheld_[id] || id == beside || partnerOf(id) == beside) continue;
      const std::size_t partner = partnerOf(id);
      if (partner == 0) continue;
      if (pairs-- == 1 && returned != 0) restore(returned);
      withhold(id);
      withhold(partner);
    }
  }

  // Returns the last withheld fragment that touches one that is kept; 0 if there is none.
  std::size_t lastBesidePair() const {
    std::size_t id = last();
    while (id > 0 && (!withheld_[id] || partnerOf(id) == 0)) --id;
    return id;
  }

  void withholdAny() {
    std::size_t id = last();
    while (withheld_[id]) --id;
    withhold(id);
  }

  std::size_t left_;  // to withhold
  std::vector<std::vector<std::size_t>> neighbors_;
  std::vector<std::size_t> touching_;  // [fragments + 1] kept neighbors
  std::vector<bool> withheld_;
};

}  // namespace

std::vector<bool> withheldByContacts(std::size_t fragments, std::size_t count,
                                     std::span<const CrackArea> contacts) {
  return Withholding(fragments, count, contacts).run();
}

std::size_t aloneByContacts(const std::vector<bool>& withheld,
                            std::span<const CrackArea> contacts) {
  const std::size_t count = withheld.size();
  std::vector<bool> touches(count, false), touchesKept(count, false);
  const auto add = [&](std::size_t id, std::size_t other) {
    if (id >= count) return;
    touches[id] = true;
    if (other < count && !withheld[other]) touchesKept[id] = true;
  };
  for (const CrackArea& contact : contacts) {
    add(contact.a, contact.b);
    add(contact.b, contact.a);
  }
  std::size_t alone = 0;
  for (std::size_t id = 1; id < count; ++id) {
    if (!withheld[id] && touches[id] && !touchesKept[id]) ++alone;
  }
  return alone;
}

}  // namespace sherd
