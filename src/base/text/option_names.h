// The names of options' values in the order of their enums, for the command line and manifests.
#pragma once

#include <cstddef>

namespace sherd::names {

inline constexpr const char* kMetric[] = {"euclidean", "chebyshev", "manhattan"};
inline constexpr const char* kFill[] = {"auto", "winding", "parity", "flood", "shell"};
inline constexpr const char* kBodies[] = {"unite", "keep"};
inline constexpr const char* kSampler[] = {"uniform", "halton", "gaussian", "poisson"};
inline constexpr const char* kSeedsOn[] = {"auto", "volume", "surface", "wall"};
inline constexpr const char* kSizes[] = {"grown", "uniform", "lognormal", "power", "exponential"};
inline constexpr const char* kErodeShape[] = {"cross", "square", "ellipse"};
inline constexpr const char* kErodeOn[] = {"fracture", "all", "rims"};
inline constexpr const char* kIslands[] = {"erode", "keep"};
inline constexpr const char* kMissingRule[] = {"neighbors", "any"};
inline constexpr const char* kMaterial[] = {"none",    "ceramic", "stone",    "glass", "tempered",
                                            "plaster", "wood",    "concrete", "ice"};
inline constexpr const char* kInterface[] = {"shared", "independent"};
inline constexpr const char* kSurface[] = {"smooth", "labels", "exact", "auto"};
inline constexpr const char* kSmoothing[] = {"taubin", "laplacian"};
inline constexpr const char* kIsolated[] = {"keep", "regrow"};  // by GrowOptions::regrowIsolated
inline constexpr const char* kPointSampler[] = {"uniform", "halton", "poisson"};
inline constexpr const char* kPointRule[] = {"area", "per-triangle"};
inline constexpr const char* kPointFormat[] = {"ply", "xyz", "npz", "binp"};
inline constexpr const char* kMeshFileFormat[] = {"ply", "obj", "glb", "stl", "stl-ascii", "binm"};
inline constexpr const char* kUsdFormat[] = {"usda", "usdz"};
inline constexpr const char* kVoxelFormat[] = {"rle", "npy", "npz", "vox", "qstack", "bing"};
inline constexpr const char* kVdbFiles[] = {"files", "single", "both"};
inline constexpr const char* kCoordinateBasis[] = {"format", "file", "option"};
inline constexpr const char* kPrecision[] = {"auto", "single", "double"};
inline constexpr const char* kVdbCompression[] = {"blosc", "zip", "none"};
inline constexpr const char* kDatasetLayout[] = {"sherd", "packed", "paper", "bb", "hdf5", "pfpp"};
inline constexpr const char* kFileCompression[] = {"none", "zip", "zstd"};
inline constexpr const char* kSampleType[] = {"float32", "float16"};

/// Returns the name of a value.
template <class Value, std::size_t n>
const char* of(const char* const (&names)[n], Value value) {
  return names[static_cast<std::size_t>(value)];
}

}  // namespace sherd::names
