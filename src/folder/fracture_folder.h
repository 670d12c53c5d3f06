// The folder that a fracture goes into.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace sherd {

/// A fracture on its way into a folder, in place of the one that is there, as writeFracture
/// promises.  What is not kept goes with this, and the folder is as it was.
class FractureReplacement {
 public:
  ///   fresh   its files but for the manifest, relative to the folder
  ///   throws  Error(output)
  FractureReplacement(std::filesystem::path folder, std::vector<std::string> fresh);
  ~FractureReplacement();
  FractureReplacement(FractureReplacement&& other) noexcept;

  /// Write the files and the manifest aside: `write` is given a folder whose sub-folders are there.
  ///   throws  Error(output); what `write` throws
  void write(const std::function<void(const std::filesystem::path&)>& write);

  /// A sentence on files that the earlier manifest lists and that stay: no fracture's file is named
  /// so.
  [[nodiscard]] const std::vector<std::string>& warnings() const;

  /// Nothing but renames, which are undone unless kept.  To be within an Uncut until then.
  ///   throws  Error(output), and all is as it was, or will be when the folder is opened again
  void putInPlace();

  /// Undo that.
  ///   return  a sentence on what cannot be undone; else nothing
  [[nodiscard]] std::string takeBack();

  ///   return  the manifest's path
  std::filesystem::path keep();

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace sherd
