// What shapes a dataset, as text.
#pragma once

#include <sherd/dataset.h>

#include <string>

namespace sherd {

/// Whether a text, also one of an earlier version, is the identity of a dataset with these options.
[[nodiscard]] bool isIdentityOf(const DatasetOptions& options, const std::string& text);

/// Returns the options of an identity.
///   throws  Error(usage) an option or a value that does not exist
[[nodiscard]] DatasetOptions optionsOfIdentity(const std::string& identity);

/// Returns the surface of a dataset's fractures: Surface::automatic stands for Surface::smooth
/// there, which takes less time.
[[nodiscard]] inline Surface surfaceOfDataset(const FractureOptions& each) {
  const Surface surface = each.surface.surface;
  return surface == Surface::automatic ? Surface::smooth : surface;
}

/// Checks the options, and returns them as the layout takes them: loaders of Breaking Bad read only
/// vertices and faces, and every file as a piece.
///   throws  Error(usage)
[[nodiscard]] DatasetOptions checkedOptions(DatasetOptions options);

}  // namespace sherd
