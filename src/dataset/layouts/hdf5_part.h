// The arrays of a fracture in the layout hdf5, and the files that keep them until all are joined.
#pragma once

#include <sherd/files.h>
#include <sherd/fracture.h>

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "formats/arrays/hdf5_file.h"

namespace sherd {

/// Arrays by their path below the group of a fracture: "pieces/00/vertices".
using Hdf5Arrays = std::vector<std::pair<std::string, Hdf5Array>>;

inline constexpr const char* kHdf5Part = ".part";  ///< extension

/// Returns the arrays of a fracture, for the fragments that are not withheld:
///
///     pieces/00/vertices      float32 [n, 3]
///     pieces/00/faces         int32 [m, 3]
///     pieces/00/shared_faces  int16 [m]: index of the fragment on the other side, -1 on the
///                             original surface; fragments that are withheld, or none because of
///                             erosion: the number of fragments
///     pieces_names            text [fragments]
///     removal_masks           boolean [k, fragments], with `removal`: row i has the fragments
///     removal_order           that are left without the first i+1 of removal_order, int64 [k]
///
/// The most voluminous fragment goes first whose removal cuts the others into no more connected
/// parts than before; the most voluminous of all stays to the end.  k is at most kMostRemovals.
[[nodiscard]] Hdf5Arrays hdf5Arrays(const FractureResult& result, bool removal);

/// Returns the arrays of the intact object: vertices, faces.
[[nodiscard]] Hdf5Arrays hdf5WholeArrays(const FractureResult& result);

inline constexpr std::size_t kMostRemovals = 64;

/// Returns the key of a fragment in "pieces": zero-padded, as loaders sort keys as text.
[[nodiscard]] std::string hdf5Key(std::size_t fragment, std::size_t fragments);

/// Returns the paths that hdf5Arrays may use, in its order.
[[nodiscard]] std::vector<std::string> hdf5Paths(std::size_t fragments);

/// Writes arrays into a file of their own.
///   throws  Error(output)
void writeHdf5Part(const OutputFile& file, const Hdf5Arrays& arrays);

/// Parses such a file.
///   throws  Error(input) without the file's name: damaged
[[nodiscard]] Hdf5Arrays parsedHdf5Part(std::string_view bytes);

}  // namespace sherd
