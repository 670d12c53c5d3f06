// Writes points and distance samples of a fracture.
#include "folder/files/write_points.h"

#include <sherd/error.h>

#include <algorithm>
#include <cstdint>
#include <span>

#include "base/progress_part.h"
#include "formats/points/write_blocks.h"
#include "points/check_points.h"
#include "points/contact_sequence.h"
#include "points/distance_sequence.h"
#include "points/point_sequence.h"
#include "points/sample_surface.h"
#include "surface/fragment_surfaces.h"

namespace sherd {

std::vector<std::size_t> sharedCounts(const FractureResult& result, std::size_t fragments,
                                      std::size_t count) {
  std::vector<double> areas;
  for (const Fragment& fragment : std::span(result.fragments).first(fragments)) {
    const auto id = static_cast<std::uint16_t>(fragment.id);
    areas.push_back(result.unmerged ? result.unmerged->measured(id).area : fragment.area);
  }
  return shareOut(count, areas);
}

namespace {

// Calls use(surface) with the surface of fragment i.
template <class Use>
void withSurface(const FractureResult& result, std::size_t i, const Use& use) {
  const Fragment& fragment = result.fragments[i];
  const auto& surfaces = result.surfaces ? result.surfaces : result.unmerged;
  if (surfaces) return use(surfaces->byArea(static_cast<std::uint16_t>(fragment.id)));
  // The same points whether or not the input has attributes.
  if (fragment.cutFaces.empty()) return use(SurfaceByArea(fragment.mesh));
  const TriangleMesh whole = uncut(fragment);
  use(SurfaceByArea(whole));
}

void writeInFormats(const OutputFolder& folder, const std::vector<std::string>& files,
                    const Blocks<SurfacePoints>& points, const WriteOptions& write) {
  for (std::size_t k = 0; k < files.size(); ++k) {
    writePoints(folder / files[k], points, write.pointFormats[k]);
  }
}

// Refuses what does not fit into an .npz file, before any point is sampled.
void requireRoom(const OutputFile& file, const ContactSequence& points) {
  constexpr std::uint64_t kPerPoint = 2 * 4 + 2 * 12, kMost = 0xffff0000U / kPerPoint;
  const std::uint64_t contacts = points.contacts();
  if (contacts == 0 || points.countPerContact() <= kMost / contacts) return;
  throw Error(ErrorCode::output,
              file.string() + ": an .npz file holds at most 4 GiB, which are " +
                  std::to_string(kMost / contacts) + " points on each of " +
                  std::to_string(contacts) + " contacts, not " +
                  std::to_string(points.countPerContact()),
              OptionNames{"correspondences"});
}

}  // namespace

SurfacePoints pointsOf(const FractureResult& result, std::size_t i, const PointOptions& points) {
  const PointOptions options = pointOptionsOf(points, result.fragments[i].id);
  SurfacePoints sampled;
  if (options.count == 0) return sampled;
  withSurface(result, i,
              [&](const SurfaceByArea& surface) { sampled = samplePoints(surface, options); });
  requireFinite(sampled, result.fragments[i].id);
  return sampled;
}

std::uint64_t pointMemory(const WriteOptions& write, std::size_t count) {
  PointOptions options = write.points;
  options.count = count;
  const bool hasOctree = std::ranges::count(write.pointFormats, PointFormat::binp) > 0;
  return count == 0 ? 0 : samplingMemory(options) + (hasOctree ? kBinpPerPoint * count : 0);
}

void writePointsOf(const OutputFolder& folder, const std::vector<std::string>& files,
                   const FractureResult& result, std::size_t i, std::size_t count,
                   std::uint64_t seed, const WriteOptions& write, MemoryGate& gate) {
  if (count == 0) return writeInFormats(folder, files, oneBlock(SurfacePoints()), write);
  const MemoryGate::Hold memory(gate, pointMemory(write, count));
  PointOptions options = write.points;
  options.count = count;
  options.seed = seed;
  options = pointOptionsOf(options, result.fragments[i].id);
  withSurface(result, i, [&](const SurfaceByArea& surface) {
    const PointSequence points(surface, options);
    const int id = result.fragments[i].id;
    if (count > kSamplesPerBlock)
      return writeInFormats(folder, files, finite(points.blocks(), id), write);
    const SurfacePoints all = points.points(0, count);
    writeInFormats(folder, files, finite(oneBlock(all), id), write);
  });
}

void writeAllCorrespondences(const OutputFile& file, std::span<const Fragment> fragments,
                             std::size_t countPerContact, std::uint64_t seed) {
  const ContactSequence points(fragments, countPerContact, seed);
  requireRoom(file, points);
  if (points.contacts() * countPerContact > kSamplesPerBlock) {
    return writeCorrespondences(file, points.blocks());
  }
  writeCorrespondences(file, sampleCorrespondences(fragments, countPerContact, seed));
}

void writeAllDistances(const OutputFolder& folder, const FractureFiles& files,
                       const FractureResult& result, const TriangleMesh& intact, std::uint64_t seed,
                       DistanceOptions options, const Progress* progress) {
  if (!(options.sigma > 0.0)) options.sigma = result.solid.frame.voxelSize;
  double done = 0.0;
  const auto all = static_cast<double>(result.kept() + 1);
  const auto write = [&](const std::string& file, const TriangleMesh& mesh, int id) {
    options.seed = pointOptionsOf({.seed = seed}, id).seed;
    const Progress part = partOf(progress, done / all, (done + 1.0) / all);
    writeDistances(folder / file, DistanceSequence(mesh, options, &part).blocks());
    ++done;
  };
  write(files.solidSdf, intact, 0);
  for (std::size_t i = 0; i < result.kept(); ++i) {
    write(files.sdf[i], result.fragments[i].mesh, result.fragments[i].id);
  }
}

}  // namespace sherd
