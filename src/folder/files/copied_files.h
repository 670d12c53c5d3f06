// Files of fragments that stay when other fragments of a fracture are broken again.
#pragma once

#include <sherd/folder.h>

#include <string>
#include <unordered_set>
#include <vector>

namespace sherd {

/// Copies files byte for byte where their content stays: the fragment is not broken, and the
/// options of its files are what they were.  Const member functions are thread-safe.
class CopiedFiles {
 public:
  CopiedFiles() = default;  ///< there are none

  ///   result    of breaking `finished` again; only what is known before its fragments is used
  ///   isDouble  meshes are written in double precision, in formats that hold it
  CopiedFiles(const FinishedFracture& finished, const FractureResult& result,
              const FractureOptions& options, const WriteOptions& write, bool isDouble);

  // Each copies a file with its name, relative to the fracture's folder.  They return false where
  // it has to be written.

  [[nodiscard]] bool copyLevelSet(const Fragment& fragment, const std::string& name,
                                  const OutputFolder& to) const;
  /// Of a fragment beside a broken one all but the neighbors stays: in `.ply` these are replaced,
  /// and `.glb` is written.
  [[nodiscard]] bool copyMesh(const Fragment& fragment, const std::string& name,
                              const OutputFolder& to) const;
  [[nodiscard]] bool copyPoints(const Fragment& fragment, const std::string& name,
                                const OutputFolder& to) const;
  [[nodiscard]] bool copyProxy(const Fragment& fragment, const std::string& name,
                               const OutputFolder& to) const;
  /// Of meshes that are kept.
  [[nodiscard]] bool copyMaterials(const std::string& name, const OutputFolder& to) const;

 private:
  bool isSame(const Fragment& fragment, bool areSame, const std::string& name) const;
  void copy(const std::string& name, const OutputFolder& to) const;

  std::filesystem::path manifest_{};
  std::unordered_set<std::string> listed_{};
  std::vector<bool> stays_{}, isBeside_{};  ///< [old fragments + 1] not broken; beside a broken one
  bool arePlain_ = false;
  // Whether the options of a kind of files are what they were.
  bool levelSets_ = false, meshes_ = false, points_ = false, proxies_ = false;
};

}  // namespace sherd
