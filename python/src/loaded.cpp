// A fracture read from its folder.
#include <sherd/error.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/input_error.h"
#include "base/memory.h"
#include "folder/manifest/read_manifest.h"
#include "folder/read/fragment_meshes.h"
#include "fracture.h"
#include "points/sample_surface.h"

namespace pysherd {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using sherd::Contact;
using sherd::Fragment;

glm::dvec3 vectorIn(const json& numbers) {
  return {numbers.at(0).get<double>(), numbers.at(1).get<double>(), numbers.at(2).get<double>()};
}

std::vector<Contact> contactsIn(const json& fragment) {
  std::vector<Contact> contacts;
  const auto add = [&](const json& some, bool areThin) {
    for (const json& own : some) {
      contacts.push_back({own.at("id").get<int>(), own.at("area").get<double>(),
                          vectorIn(own.at("normal")), vectorIn(own.at("centroid")), areThin});
    }
  };
  add(fragment.at("contacts"), false);
  add(fragment.value("thin_contacts", json::array()), true);
  std::sort(contacts.begin(), contacts.end(),
            [](const Contact& a, const Contact& b) { return a.fragment < b.fragment; });
  return contacts;
}

}  // namespace

LoadedPieces::LoadedPieces(const std::string& folder)
    : file_(sherd::whatIsAt(folder) == fs::file_type::directory
                ? (fs::path(folder) / sherd::kManifestName).string()
                : folder),
      manifest_(sherd::readManifest(file_)) {
  const json manifest = sherd::manifestJson(file_).value();
  try {
    frame_ = {manifest_.origin, manifest_.voxelSize};
    for (const json& fragment : manifest.at("fragments")) {
      if (fragment.value("withheld", false)) continue;
      contacts_.push_back(contactsIn(fragment));
    }
  } catch (const json::exception& e) {
    sherd::inputError(file_, std::string("is no manifest of this version: ") + e.what());
  }
}

VoxelIds LoadedPieces::labels(const sherd::Progress&) {
  for (const char* name : {"labels.rle", "labels.npy", "labels.npz", "labels.qstack"}) {
    if (std::find(manifest_.files.begin(), manifest_.files.end(), name) == manifest_.files.end()) {
      continue;
    }
    sherd::VoxelLabels read = expand(sherd::readVoxels(sherd::listedFile(file_, name)).voxels);
    for (std::uint16_t& label : read.labels) {  // 1 is the solid's, k + 1 is fragment k's
      if (label != 0) label = label == 1 ? kNoFragment : static_cast<std::uint16_t>(label - 1);
    }
    return {read.dims, std::move(read.labels)};
  }
  sherd::inputError(file_, "the fracture was written without labels.rle, .npy, .npz or .qstack");
}

sherd::FinishedFracture LoadedPieces::finished(const sherd::Progress&) {
  const std::uint64_t memory = sherd::freeMemory();
  sherd::FinishedFracture finished = sherd::readFracture(file_, {.maxMemory = memory});
  readFragmentMeshes(file_, finished, memory);
  finished.source.coordinates = manifest_.coordinates;
  return finished;
}

SolidPtr LoadedPieces::solidOf(const sherd::FinishedFracture& finished) const {
  sherd::PreparedSolid whole;
  whole.solid = finished.solid;
  return freedElsewhere(std::make_unique<Solid>(GivenOptions(), std::vector<std::string>(), 0.0,
                                                manifest_.offset, finished.source, std::move(whole),
                                                std::string()));
}

std::vector<Fragment> LoadedPieces::made(const sherd::Progress& progress) {
  sherd::reportProgress(&progress, "read", 0.0);
  std::vector<Fragment> fragments = sherd::readPieces(fs::path(file_).parent_path()).fragments;
  if (fragments.size() != manifest_.fragments.size() || contacts_.size() != fragments.size()) {
    sherd::inputError(file_, "lists another number of fragments than there are files of");
  }
  for (std::size_t i = 0; i < fragments.size(); ++i) {
    const sherd::ManifestFragment& listed = manifest_.fragments[i];
    fragments[i].voxels = listed.voxels;
    fragments[i].area = listed.area;
    fragments[i].fractureArea = listed.fractureArea;
    fragments[i].contacts = contacts_[i];
    for (const std::vector<std::string>& files : listed.decimated) {
      const fs::path file = sherd::listedFile(file_, sherd::meshWithNeighbors(files));
      fragments[i].coarse.push_back(sherd::readMesh(file, {.maxMemory = sherd::freeMemory()}).mesh);
    }
  }
  sherd::reportProgress(&progress, "read", 1.0);
  return fragments;
}

}  // namespace pysherd
