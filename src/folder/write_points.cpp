// Writes points and distance samples of a fracture.
#include "folder/write_points.h"

#include <cstdint>
#include <span>

#include "points/check_points.h"
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

SurfacePoints pointsOf(const FractureResult& result, std::size_t i, const PointOptions& points) {
  const Fragment& fragment = result.fragments[i];
  const PointOptions options = pointOptionsOf(points, fragment.id);
  const auto& surfaces = result.surfaces ? result.surfaces : result.unmerged;
  if (options.count == 0) return {};
  // The same points whether or not the input has attributes.
  const auto sampled = [&] {
    if (surfaces)
      return samplePoints(surfaces->byArea(static_cast<std::uint16_t>(fragment.id)), options);
    return fragment.cutFaces.empty() ? samplePoints(fragment.mesh, options)
                                     : samplePoints(uncut(fragment), options);
  };
  return checkedPoints(sampled(), fragment.id);
}

void writePointsOf(const OutputFolder& folder, const std::vector<std::string>& files,
                   const FractureResult& result, std::size_t i, std::size_t count,
                   std::uint64_t seed, const WriteOptions& write) {
  PointOptions options = write.points;
  options.count = count;
  options.seed = seed;
  const SurfacePoints points = pointsOf(result, i, options);
  for (std::size_t k = 0; k < files.size(); ++k) {
    writePoints(folder / files[k], points, write.pointFormats[k]);
  }
}

void writeAllDistances(const OutputFolder& folder, const FractureFiles& files,
                       const FractureResult& result, const TriangleMesh& intact, std::uint64_t seed,
                       DistanceOptions options, const Progress* progress) {
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
    options.seed = pointOptionsOf({.seed = seed}, id).seed;
    writeDistances(folder / file, sampleDistances(mesh, options, &ofAll));
    ++done;
  };
  write(files.solidSdf, intact, 0);
  for (std::size_t i = 0; i < result.kept(); ++i) {
    write(files.sdf[i], result.fragments[i].mesh, result.fragments[i].id);
  }
}

}  // namespace sherd
