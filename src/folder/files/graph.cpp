// The contact graph, for simulations.
#include <sherd/folder.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/text/json_of.h"
#include "base/text/json_text.h"
#include "folder/manifest/split_parents.h"
#include "formats/mesh/each_contact.h"

namespace sherd {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint32_t kNoParent = 0xffffffffu;  // Blast's value for the root

Json chunkJson(const glm::dvec3& centroid, double volume, std::uint32_t parent, bool isSupport,
               int userData) {
  return {{"centroid", jsonOf(centroid)},
          {"volume", volume},
          {"parentChunkIndex", parent},
          {"flags", isSupport ? 1 : 0},
          {"userData", userData}};
}

// A piece before it was split, of the fragments that come of it.
struct Piece {
  double volume = 0.0;
  glm::dvec3 moment{0.0};

  glm::dvec3 centroid() const { return volume > 0.0 ? moment / volume : moment; }
};

// [1 + splits] the intact object, and what each split divided.
std::vector<Piece> piecesOf(std::span<const std::size_t> parentOfSplit,
                            std::span<const std::size_t> splitOfFragment,
                            std::span<const Fragment> fragments) {
  std::vector<Piece> pieces(parentOfSplit.size() + 1);
  for (const Fragment& fragment : fragments) {
    std::size_t at = splitOfFragment[static_cast<std::size_t>(fragment.id - 1)];
    for (;; at = parentOfSplit[at - 1]) {
      pieces[at].volume += fragment.mass.volume;
      pieces[at].moment += fragment.mass.volume * fragment.mass.centroid;
      if (at == 0) break;
    }
  }
  return pieces;
}

}  // namespace

void writeGraph(const OutputFile& file, std::span<const Fragment> fragments,
                const GridMetadata& metadata, std::span<const Split> splits) {
  const SplitParents parents = parentsOf(splits, fragments.size());
  const std::vector<Piece> pieces = piecesOf(parents.ofSplit, parents.ofFragment, fragments);
  // The chunk of each split: those of fragments come first, so that they have their ids.
  std::vector<std::uint32_t> chunkOf(pieces.size(), 0);
  auto next = static_cast<std::uint32_t>(fragments.size());
  for (std::size_t i = parents.hasWhole() ? 2 : 1; i < pieces.size(); ++i) {
    if (pieces[i].volume > 0.0) chunkOf[i] = ++next;
  }
  Json chunks =
      Json::array({chunkJson(pieces[0].centroid(), pieces[0].volume, kNoParent, false, 0)});
  for (const Fragment& fragment : fragments) {
    const auto index = static_cast<std::size_t>(fragment.id - 1);
    Json chunk = chunkJson(fragment.mass.centroid, fragment.mass.volume,
                           chunkOf[parents.ofFragment[index]], true, fragment.id);
    chunk["mass"] = metadata.density * fragment.mass.volume;
    chunks.push_back(std::move(chunk));
  }
  for (std::size_t i = 1; i < pieces.size(); ++i) {
    if (chunkOf[i] == 0) continue;
    chunks.push_back(chunkJson(pieces[i].centroid(), pieces[i].volume,
                               chunkOf[parents.ofSplit[i - 1]], false, 0));
  }
  Json bonds = Json::array();
  forEachContact(fragments, [&](std::size_t one, std::size_t other, const Contact& contact) {
    bonds.push_back({{"chunkIndices", {fragments[one].id, fragments[other].id}},
                     {"normal", jsonOf(contact.normal)},
                     {"area", contact.area},
                     {"centroid", jsonOf(contact.centroid)},
                     {"userData", 0}});
  });
  const Json graph = {{"schema", "sherd-graph/1"},
                      {"source", metadata.source},
                      {"density", metadata.density},
                      {"chunks", std::move(chunks)},
                      {"bonds", std::move(bonds)}};
  file.write(jsonText(graph, 1) + "\n");
}

}  // namespace sherd
