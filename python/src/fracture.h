// A fracture whose fragments are made when they are first read.
#pragma once

#include <sherd/folder.h>
#include <sherd/fracture.h>
#include <sherd/points.h>

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/fracture_stages.h"
#include "solid.h"
#include "surface/extract.h"

namespace pysherd {

/// The fragments of voxels: ids, 0 outside, kNoFragment in the solid but in no fragment.
inline constexpr std::uint16_t kNoFragment = sherd::Labels::kEroded;

struct VoxelIds {
  openvdb::Coord dims;
  std::vector<std::uint16_t> ids;  ///< [dims.x * dims.y * dims.z], z fastest
};

/// How many points, and of which kind.
struct PointChoice {
  sherd::PointOptions points{};
  bool isShared = false;  ///< `count` is the total, distributed by areas
};

class Fracture : public std::enable_shared_from_this<Fracture> {
 public:
  virtual ~Fracture() = default;

  /// Fragments that are not withheld, with ids 1..count().
  [[nodiscard]] virtual std::size_t count() const = 0;
  [[nodiscard]] virtual sherd::GridFrame frame() const = 0;  ///< origin: voxel (0,0,0) of labels()
  [[nodiscard]] virtual VoxelIds labels() const = 0;
  [[nodiscard]] virtual std::uint64_t seed() const = 0;

  /// The fragments with mass, areas, voxels and contacts; perhaps without meshes.
  [[nodiscard]] virtual const std::vector<sherd::Fragment>& measured(const sherd::Progress&) = 0;

  /// The fragments with meshes.
  [[nodiscard]] virtual const std::vector<sherd::Fragment>& meshed(const sherd::Progress&) = 0;

  /// Samples points of each fragment.
  [[nodiscard]] std::vector<sherd::SurfacePoints> points(PointChoice choice,
                                                         const sherd::Progress& progress);

  /// Why exact surfaces were replaced by smooth ones, as a clause; empty if they were not.
  [[nodiscard]] virtual std::string exactFailure() const { return {}; }

 protected:
  /// Samples points of one fragment, with a seed of its own.
  [[nodiscard]] virtual sherd::SurfacePoints pointsOf(std::size_t i,
                                                      const sherd::PointOptions& options) = 0;
  /// Makes what pointsOf reads.
  virtual void preparePoints(const sherd::Progress& progress) = 0;
};

/// A fracture of a solid.
class GrownPieces : public Fracture {
 public:
  GrownPieces(SolidPtr solid, GivenOptions given, sherd::RunOptions run, sherd::GrownFracture grown)
      : solid_(std::move(solid)),
        given_(std::move(given)),
        run_(std::move(run)),
        grown_(std::move(grown)) {}

  [[nodiscard]] std::size_t count() const override {
    return static_cast<std::size_t>(grown_.result.labels.fragmentCount) - grown_.result.withheld;
  }
  [[nodiscard]] sherd::GridFrame frame() const override;
  [[nodiscard]] VoxelIds labels() const override;
  [[nodiscard]] std::uint64_t seed() const override { return run_.fracture.seed; }
  [[nodiscard]] const std::vector<sherd::Fragment>& measured(const sherd::Progress&) override;
  [[nodiscard]] const std::vector<sherd::Fragment>& meshed(const sherd::Progress&) override;
  [[nodiscard]] std::string exactFailure() const override;

  [[nodiscard]] const SolidPtr& solid() const { return solid_; }
  [[nodiscard]] const GivenOptions& given() const { return given_; }

  /// Writes the files that `write` names.
  ///   return  sentences about what may be lost, or was kept
  [[nodiscard]] std::vector<std::string> save(const std::string& folder,
                                              const sherd::WriteOptions& write,
                                              const sherd::Progress& progress);

 protected:
  [[nodiscard]] sherd::SurfacePoints pointsOf(std::size_t i,
                                              const sherd::PointOptions& options) override;
  void preparePoints(const sherd::Progress& progress) override { (void)measured(progress); }

 private:
  [[nodiscard]] sherd::SurfaceOptions surface(bool meshes) const;

  SolidPtr solid_;
  GivenOptions given_;
  sherd::RunOptions run_;
  mutable std::mutex making_;   // guards the rest
  sherd::GrownFracture grown_;  // its fragments are those of measured()
  bool isMeasured_ = false;
  std::optional<sherd::ExtractedFragments> meshed_;
};

/// A fracture read from its folder.
class LoadedPieces : public Fracture {
 public:
  /// Reads the manifest.
  explicit LoadedPieces(const std::string& folder);

  [[nodiscard]] std::size_t count() const override { return manifest_.fragments.size(); }
  [[nodiscard]] sherd::GridFrame frame() const override { return frame_; }
  [[nodiscard]] VoxelIds labels() const override;
  [[nodiscard]] std::uint64_t seed() const override { return manifest_.seed; }
  [[nodiscard]] const std::vector<sherd::Fragment>& measured(const sherd::Progress& p) override {
    return meshed(p);
  }
  [[nodiscard]] const std::vector<sherd::Fragment>& meshed(const sherd::Progress&) override;

  [[nodiscard]] const std::string& file() const { return file_; }

 protected:
  [[nodiscard]] sherd::SurfacePoints pointsOf(std::size_t i,
                                              const sherd::PointOptions& options) override;
  void preparePoints(const sherd::Progress& progress) override { (void)meshed(progress); }

 private:
  std::string file_;  // the manifest's path
  sherd::Manifest manifest_;
  sherd::GridFrame frame_;
  std::vector<std::vector<sherd::Contact>> contacts_;
  std::mutex making_;
  std::vector<sherd::Fragment> meshed_;
};

/// Breaks a solid several times by the same options but for pieces and seed, growing together.
[[nodiscard]] std::vector<std::shared_ptr<GrownPieces>> broken(
    const SolidPtr& solid, const GivenOptions& given,
    const std::vector<std::pair<int, std::uint64_t>>& piecesAndSeeds, const std::string& device,
    const sherd::Progress& progress);

}  // namespace pysherd
