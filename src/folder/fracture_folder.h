// Replacement of the fracture in a folder.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace sherd {

/// Replaces the fracture in a folder as documented at writeFracture.  The destructor restores the
/// folder unless keep() was called.
class FractureReplacement {
 public:
  ///   fresh   the new files without the manifest, relative to the folder
  ///   throws  Error(output)
  FractureReplacement(std::filesystem::path folder, std::vector<std::string> fresh);
  ~FractureReplacement();
  FractureReplacement(FractureReplacement&& other) noexcept;

  /// Writes the files and the manifest to a hidden folder: `write` gets a folder with all
  /// subfolders.
  ///   throws  Error(output); what `write` throws
  void write(const std::function<void(const std::filesystem::path&)>& write);

  /// A sentence about files that the earlier manifest lists but that are kept, as no fracture's
  /// file has such a name; else empty.
  [[nodiscard]] const std::vector<std::string>& warnings() const;

  /// Only renames, which are undone unless keep() is called.  Call both within one Uncut.
  ///   throws  Error(output); the folder is restored, now or when it is opened again
  void putInPlace();

  /// Undoes putInPlace().
  ///   return  if that fails, a sentence about it; else empty
  [[nodiscard]] std::string takeBack();

  /// Makes putInPlace() final.
  ///   return  the manifest's path
  std::filesystem::path keep();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace sherd
