// Verifies the fractures of the layout hdf5.
#include "dataset/layouts/hdf5_verify.h"

#include <sherd/error.h>

#include <utility>

#include "base/files/below_folder.h"
#include "base/files/file_bytes.h"
#include "base/files/sha256.h"
#include "base/input_error.h"
#include "dataset/layouts/fracture_line.h"
#include "dataset/layouts/hdf5_lists.h"
#include "dataset/layouts/hdf5_part.h"
#include "dataset/layouts/hdf5_record.h"

namespace sherd {
namespace {

void requireFaces(const std::string& name, const Hdf5Array& faces, const Json& fragment) {
  if (faces.shape.front() == fragment.at("faces").get<std::size_t>()) return;
  throw Error(ErrorCode::input, name + ": has " + std::to_string(faces.shape.front()) +
                                    " faces, not " + fragment.at("faces").dump());
}

}  // namespace

JoinedFractures::JoinedFractures(std::filesystem::path out)
    : out_(std::move(out)), files_(joinedFiles(out_)) {
  for (const JoinedFile& file : files_) {
    if (sha256OfFile(out_ / file.name) == file.sha256) {
      readers_[file.name] = std::make_unique<Hdf5Reader>(out_ / file.name);
    } else {
      problems_.push_back(differs(file.name));
    }
  }
}

void JoinedFractures::check(const LibraryObject& object, const std::string& meshSum,
                            const Json& line) const {
  const std::string name = hdf5Name(line);
  const FileRecord part = filesOf(line).front();
  std::map<std::string, Hdf5Array> arrays;
  const Hdf5Reader* reader = nullptr;
  if (isOwnFile(out_, part.name)) {
    const std::string bytes = readFileBytes(out_ / part.name);
    if (bytes.size() != part.bytes || sha256(bytes) != part.sha256)
      throw Error(ErrorCode::input, part.name + ": differs from what was written");
    for (auto& [path, array] : parsedHdf5Part(bytes)) arrays.emplace(path, std::move(array));
  } else {
    bool isHeld = false;
    for (const JoinedFile& file : files_) {
      if (!file.holds(object, meshSum)) continue;
      isHeld = true;
      if (readers_.contains(file.name)) reader = readers_.at(file.name).get();
    }
    if (!isHeld) throw Error(ErrorCode::input, hdf5Group(object) + "/" + name + ": is missing");
    if (reader == nullptr) return;  // of a file that differs, which is a problem of its own
  }
  const bool isWhole = line.at("fracture") == kWholeName;
  const std::size_t kept = hdf5Kept(line);
  for (std::size_t i = 0; i < kept; ++i) {
    const std::string path = isWhole ? "faces" : "pieces/" + hdf5Key(i, kept) + "/faces";
    const std::string shown = hdf5Group(object) + "/" + name + "/" + path;
    std::optional<Hdf5Array> faces;
    if (reader != nullptr) {
      faces = reader->read(shown);
    } else if (const auto found = arrays.find(path); found != arrays.end()) {
      faces = std::move(found->second);
    }
    if (!faces) throw Error(ErrorCode::input, shown + ": is missing");
    requireFaces(shown, *faces, line.at("fragments").at(i));
  }
}

}  // namespace sherd
