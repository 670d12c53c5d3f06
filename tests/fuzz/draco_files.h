// Meshes packed by Draco, and the .glb that holds one.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace sherd::fuzz {

/// Streams of Draco's own encoder, by both of its methods, and their beginnings.
[[nodiscard]] std::vector<std::string> dracoStreams();

/// .glb files that hold these, in each form of wrappedDraco().
[[nodiscard]] std::vector<std::string> dracoGlbs();

/// Where the vertices of wrappedDraco() are.
enum class DracoPositions {
  packed,  ///< in the stream
  plain,   ///< three in an accessor of their own, and only triangles in the stream
};

/// A .glb whose one mesh is a stream, and ends where this ends: what reads beyond the one reads
/// beyond the other, where a sanitizer sees it.
[[nodiscard]] std::string wrappedDraco(std::string_view stream, DracoPositions positions);

}  // namespace sherd::fuzz
