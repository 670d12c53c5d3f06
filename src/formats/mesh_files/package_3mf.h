// The package of a 3MF file: a ZIP file of parts, some of which are models.
#pragma once

#include <cstddef>
#include <deque>
#include <string>
#include <unordered_map>
#include <vector>

#include "formats/arrays/zip_reader.h"
#include "formats/mesh/mesh_reader.h"
#include "formats/mesh_files/model_3mf.h"

namespace sherd {

/// A model, by which others are found.
struct Part3mf {
  std::size_t number = 0;  ///< in the order of parsing
  std::string name{};      ///< by partName3mf()
  Model3mf model{};
  std::vector<const Part3mf*> others{};  ///< [model.paths] null: not looked up yet
};

/// Finds parts by name; each model is parsed once, when it is first needed.
class Package3mf {
 public:
  ///   file    outlives this object; charged with its parts
  ///   throws  Error(input) no ZIP file; it takes more memory than may be used
  explicit Package3mf(const MeshFile& file);

  /// Returns the first model.
  ///   throws  Error(input) there is none; what parsed3mf() throws
  const Part3mf& root();

  /// Returns the model that a reference of the model `from` shows an object of.
  const Part3mf& partOf(const Part3mf& from, const Reference3mf& reference);

 private:
  [[nodiscard]] std::string rootName() const;
  [[nodiscard]] const ZipEntry* find(const std::string& name) const;
  [[nodiscard]] std::string unpacked(const ZipEntry& entry) const;
  Part3mf& part(const std::string& name);

  const MeshFile& file_;
  std::vector<ZipEntry> entries_;
  std::unordered_map<std::string, std::size_t> entryOf_{};  // the first of a name
  std::unordered_map<std::string, std::size_t> partOf_{};
  std::deque<Part3mf> parts_{};  // whose addresses stay
};

}  // namespace sherd
