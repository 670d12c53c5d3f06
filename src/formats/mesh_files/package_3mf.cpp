// Finds the models of a 3MF file.
#include "formats/mesh_files/package_3mf.h"

#include <algorithm>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "base/text/text_scan.h"
#include "formats/mesh_files/xml_tags.h"

namespace sherd {
namespace {

constexpr std::uint64_t kTableEntry =
    2 * (sizeof(std::string) + sizeof(std::size_t) + 2 * sizeof(void*));

}  // namespace

Package3mf::Package3mf(const MeshFile& file)
    : file_(file), entries_(zipEntries(file.bytes, file.name, file.memory)) {
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    charge(file_, kTableEntry + entries_[i].name.size());
    entryOf_.emplace(partName3mf(entries_[i].name), i);
  }
}

std::string Package3mf::rootName() const {
  if (const ZipEntry* rels = find("_rels/.rels")) {
    const std::string text = unpacked(*rels);
    XmlTags tags(withoutByteOrderMark(text));
    XmlTag tag;
    try {
      for (std::size_t count = 0; tags.next(tag); ++count) {
        if (count % kTagsAtATime == 0) checkpoint(file_);
        if (tag.name != "Relationship" || !tag["Type"].ends_with("/3dmodel")) continue;
        std::string target = decodedPartName3mf(tag["Target"]);
        if (find(target) != nullptr) return target;
      }
    } catch (const std::runtime_error& e) {  // then by its usual name
      if (dynamic_cast<const Error*>(&e) != nullptr) throw;
    }
  }
  constexpr const char* kUsual = "3d/3dmodel.model";
  if (find(kUsual) != nullptr) return kUsual;
  for (const ZipEntry& entry : entries_) {
    std::string name = partName3mf(entry.name);
    if (name.ends_with(".model")) return name;
  }
  throw inputError(file_, "has no model: it is no 3MF file");
}

const Part3mf& Package3mf::root() { return part(rootName()); }

const Part3mf& Package3mf::partOf(const Part3mf& from, const Reference3mf& reference) {
  if (reference.path == Reference3mf::kSameModel) return from;
  const Part3mf*& other = parts_[from.number].others[reference.path];
  if (other == nullptr) other = &part(from.model.paths[reference.path]);
  return *other;
}

Part3mf& Package3mf::part(const std::string& name) {
  const auto known = partOf_.find(name);
  if (known != partOf_.end()) return parts_[known->second];
  const ZipEntry* entry = find(name);
  if (entry == nullptr) {
    throw inputError(
        file_, "refers to the model '" + plainText(name.substr(0, 80)) + "', which is not in it");
  }
  charge(file_, sizeof(Part3mf) + kTableEntry + 2 * name.size());
  Part3mf made{.number = parts_.size(), .name = name};
  made.model = parsed3mf(file_, name, unpacked(*entry));
  made.others.resize(made.model.paths.size());
  partOf_.emplace(name, made.number);
  return parts_.emplace_back(std::move(made));
}

const ZipEntry* Package3mf::find(const std::string& name) const {
  const auto found = entryOf_.find(name);
  return found == entryOf_.end() ? nullptr : &entries_[found->second];
}

std::string Package3mf::unpacked(const ZipEntry& entry) const {
  charge(file_, entry.size);
  std::string text;
  text.reserve(entry.size);
  unpack(entry, file_.name, [&](std::string_view block) {
    checkpoint(file_);
    text += block;
  });
  if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff"))
    throw inputError(file_, "holds text in UTF-16, which is not read; save it as UTF-8");
  return text;
}

}  // namespace sherd
