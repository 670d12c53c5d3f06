// Writes points and distance samples of a fracture.
#include "folder/write_points.h"

#include "base/random.h"

namespace sherd {
namespace {

// Returns the seed for the points of one fragment, id 0: the whole solid.
std::uint64_t fragmentSeed(std::uint64_t seed, int id) {
  return randomBits(seed, Stage::pointFragment, static_cast<std::uint64_t>(id));
}

}  // namespace

std::vector<std::size_t> sharedCounts(std::span<const Fragment> fragments, std::size_t count) {
  std::vector<double> areas;
  for (const Fragment& fragment : fragments) areas.push_back(fragment.area);
  return shareOut(count, areas);
}

void writePointsOf(const OutputFolder& folder, const std::vector<std::string>& files,
                   const Fragment& fragment, std::size_t count, std::uint64_t seed,
                   const WriteOptions& write) {
  PointOptions options = write.points;
  options.count = count;
  options.seed = fragmentSeed(seed, fragment.id);
  const SurfacePoints points = samplePoints(fragment.mesh, options);
  for (std::size_t k = 0; k < files.size(); ++k) {
    writePoints(folder / files[k], points, write.pointFormats[k]);
  }
}

void writeAllDistances(const OutputFolder& folder, const FractureFiles& files,
                       const FractureResult& result, std::uint64_t seed, DistanceOptions options,
                       const Progress* progress) {
  if (!(options.sigma > 0.0)) options.sigma = result.solid.frame.voxelSize;
  std::size_t done = 0;
  Progress ofAll;
  if (progress) ofAll.cancelled = progress->cancelled;
  if (progress && progress->report) {
    ofAll.report = [&](std::string_view stage, double fraction) {
      progress->report(
          stage, (static_cast<double>(done) + fraction) / static_cast<double>(result.kept() + 1));
    };
  }
  const auto write = [&](const std::string& file, const TriangleMesh& mesh, int id) {
    options.seed = fragmentSeed(seed, id);
    writeDistances(folder / file, sampleDistances(mesh, options, &ofAll));
    ++done;
  };
  write(files.solidSdf, solidMesh(result.solid), 0);
  for (std::size_t i = 0; i < result.kept(); ++i) {
    write(files.sdf[i], result.fragments[i].mesh, result.fragments[i].id);
  }
}

}  // namespace sherd
