// Writes points, distance samples and correspondences of a fracture, which are sampled while they
// are written, so that a block of them is in memory at a time.
#pragma once

#include <sherd/folder.h>

#include <string>
#include <vector>

#include "base/memory_gate.h"
#include "folder/manifest/manifest.h"

namespace sherd {

/// Returns [fragments] counts that distribute `count` points over the first fragments by area, of
/// the surfaces that points lie on: the same whether or not there are meshes.
[[nodiscard]] std::vector<std::size_t> sharedCounts(const FractureResult& result,
                                                    std::size_t fragments, std::size_t count);

/// Samples points on fragment i.
///   points  `count` of it; `seed` of the fracture
[[nodiscard]] SurfacePoints pointsOf(const FractureResult& result, std::size_t i,
                                     const PointOptions& points);

/// Returns the bytes that sampling and writing points of one fragment takes at most.
[[nodiscard]] std::uint64_t pointMemory(const WriteOptions& write, std::size_t count);

/// The same as pointsOf, and writes them.
///   files  [write.pointFormats] relative to the folder
///   seed   of the fracture
///   gate   of all fragments that are written at once
void writePointsOf(const OutputFolder& folder, const std::vector<std::string>& files,
                   const FractureResult& result, std::size_t i, std::size_t count,
                   std::uint64_t seed, const WriteOptions& write, MemoryGate& gate);

/// Samples and writes correspondences.
///   fragments, countPerContact  as of sampleCorrespondences
///   throws  Error(output) more than an .npz file holds
void writeAllCorrespondences(const OutputFile& file, std::span<const Fragment> fragments,
                             std::size_t countPerContact, std::uint64_t seed);

/// Samples distances and writes files.solidSdf and files.sdf.
///   intact  the mesh of the intact object
///   seed    of the fracture
void writeAllDistances(const OutputFolder& folder, const FractureFiles& files,
                       const FractureResult& result, const TriangleMesh& intact, std::uint64_t seed,
                       DistanceOptions options, const Progress* progress);

}  // namespace sherd
