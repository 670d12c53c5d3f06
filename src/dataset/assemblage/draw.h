// What assemblages are made of: objects, pieces and intruders.
#pragma once

#include <sherd/dataset.h>

#include <vector>

namespace sherd {

/// A fracture of an assemblage.
struct AssemblageFracture {
  PlannedFracture planned;  ///< `pieces` of all objects without intruders
  std::vector<int> pieces;  ///< asked of each part that it has, an intruder's object included
};

/// Returns the fractures of an assemblage, in the order in which they are made.
///   object  of drawnAssemblages
[[nodiscard]] std::vector<AssemblageFracture> assemblageFractures(const LibraryObject& object,
                                                                  const DatasetOptions& options);

/// Returns the planned fractures of an object or an assemblage.
[[nodiscard]] std::vector<PlannedFracture> fracturesOf(const LibraryObject& object,
                                                       const DatasetOptions& options);

/// Returns what a dataset is made of: the library's objects, or assemblages of them.
[[nodiscard]] std::vector<LibraryObject> plannedObjects(const std::vector<LibraryObject>& found,
                                                        const DatasetOptions& options);

}  // namespace sherd
