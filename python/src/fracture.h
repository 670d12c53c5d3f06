// A fracture whose fragments are made when they are first read.
#pragma once

#include <sherd/folder.h>
#include <sherd/fracture.h>
#include <sherd/points.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <shared_mutex>
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
  bool isShared = false;              ///< `count` is the total, distributed by areas
  std::vector<std::size_t> counts{};  ///< [fragments] instead of `count`, or empty
};

/// The arrays of a fragment's mesh, once Python has them.
struct HandedArrays {
  std::shared_ptr<std::vector<glm::dvec3>> vertices;
  std::shared_ptr<std::vector<glm::uvec3>> triangles;
  std::shared_ptr<std::vector<std::uint16_t>> neighbor;  ///< as many as triangles
};

class Fracture : public std::enable_shared_from_this<Fracture> {
 public:
  virtual ~Fracture() = default;

  /// Fragments that are not withheld, with ids 1..count().
  [[nodiscard]] virtual std::size_t count() const = 0;
  [[nodiscard]] virtual sherd::GridFrame frame() const = 0;  ///< origin: voxel (0,0,0) of labels()
  /// What positions lack to be those of the input; 0 if the object was not recentered.
  [[nodiscard]] virtual glm::dvec3 offset() const = 0;
  /// What positions mean in space.
  [[nodiscard]] virtual sherd::CoordinateSystem coordinates() const = 0;
  [[nodiscard]] virtual VoxelIds labels(const sherd::Progress& progress) = 0;
  [[nodiscard]] virtual std::uint64_t seed() const = 0;

  /// The fragments with mass, areas, voxels and contacts; perhaps without meshes.
  [[nodiscard]] virtual const std::vector<sherd::Fragment>& measured(const sherd::Progress&) = 0;

  /// The same of the surfaces that points are sampled on: without meshes also where the triangles
  /// of these are merged, whose areas and contacts differ slightly.
  [[nodiscard]] virtual const std::vector<sherd::Fragment>& sampled(const sherd::Progress& p) {
    return measured(p);
  }

  /// The same once their meshes are made, which are in arrays() or still in the fragments.
  [[nodiscard]] const std::vector<sherd::Fragment>& meshed(const sherd::Progress& progress);

  /// Calls `read` with the fragments and their meshes, which are made again where arrays have them.
  void withMeshes(const sherd::Progress& progress,
                  const std::function<void(const std::vector<sherd::Fragment>&)>& read);

  /// Moves the arrays of a fragment's mesh to Python, whose owner they then are: nothing is copied,
  /// and what is written into them changes nothing here.  Copies them while withMeshes() reads them
  /// on another thread, and where meshes cannot be made again.  The caller has the interpreter's
  /// lock, and has called meshed().
  [[nodiscard]] const HandedArrays& arrays(std::size_t i);

  /// Returns the input's face of each face of a fragment, as many as triangles; null if the option
  /// for them was not given.  The caller has called meshed().
  [[nodiscard]] std::shared_ptr<std::vector<std::int32_t>> sourceFaces(std::size_t i) const {
    return sourceFaces_.empty() ? nullptr : sourceFaces_.at(i);
  }

  /// Samples points of each fragment.
  [[nodiscard]] std::vector<sherd::SurfacePoints> points(PointChoice choice,
                                                         const sherd::Progress& progress);

  /// Returns the fracture as it is broken again, and the options that it has then.
  [[nodiscard]] virtual sherd::FinishedFracture finished(const sherd::Progress& progress) = 0;
  [[nodiscard]] virtual sherd::RunOptions inherited() const = 0;

  /// Returns what is broken again: the solid itself, or one of files.
  ///   finished  as returned by finished()
  [[nodiscard]] virtual SolidPtr solidOf(const sherd::FinishedFracture& finished) const = 0;

  /// [fragments] the fragments that were broken again, or which stayed; empty of one break.
  [[nodiscard]] virtual std::vector<int> parents() const { return {}; }

  /// Returns which fragments have smooth surfaces instead of exact ones, and why, as a clause;
  /// empty before meshes are made, and if none has.
  [[nodiscard]] virtual std::string smoothText() const { return {}; }

  /// Returns what became of bodies of the input that overlap or touch, as a clause; empty before
  /// meshes are made, and where there are none.
  [[nodiscard]] virtual std::string unitedText() const { return {}; }

  /// Sentences about guides that split nothing, and fragments without a neighbor.
  [[nodiscard]] virtual std::vector<std::string> guideWarnings() const { return {}; }

 protected:
  /// Makes the fragments with their meshes; each time the same.
  [[nodiscard]] virtual std::vector<sherd::Fragment> made(const sherd::Progress& progress) = 0;

  /// Returns the input's faces of fragments that were made, or nothing.
  [[nodiscard]] virtual std::vector<std::shared_ptr<std::vector<std::int32_t>>> facesOf(
      const std::vector<sherd::Fragment>&) const {
    return {};
  }

  /// Whether made() gives the same again.
  [[nodiscard]] virtual bool canBeMadeAgain() const { return true; }

  /// What points of fragments are sampled on; null: their meshes.
  [[nodiscard]] virtual const sherd::FragmentSurfaces* surfaces(const sherd::Progress&) {
    return nullptr;
  }

  mutable std::mutex making_;  ///< guards what is made once

 private:
  void makeAgain(const sherd::Progress& progress);

  std::optional<std::vector<sherd::Fragment>> meshed_;
  std::shared_mutex reading_;  // of the meshes in meshed_
  bool isWhole_ = true;        // no array of them was moved away
  std::vector<std::shared_ptr<std::vector<std::int32_t>>> sourceFaces_;  // or empty
  std::vector<HandedArrays> handed_;  // guarded by the interpreter's lock
};

/// A fracture of a solid.
class GrownPieces : public Fracture {
 public:
  GrownPieces(SolidPtr solid, GivenOptions given, sherd::RunOptions run, sherd::GrownFracture grown)
      : solid_(std::move(solid)),
        given_(std::move(given)),
        run_(std::move(run)),
        grown_(std::move(grown)),
        isAgain_(grown_.exact.has_value()) {}

  [[nodiscard]] std::size_t count() const override {
    return static_cast<std::size_t>(grown_.result.labels.fragmentCount) - grown_.result.withheld;
  }
  [[nodiscard]] sherd::GridFrame frame() const override;
  [[nodiscard]] glm::dvec3 offset() const override {
    return solid_->offset().value_or(glm::dvec3(0.0));
  }
  [[nodiscard]] sherd::CoordinateSystem coordinates() const override {
    return coordinatesOf(solid_->source().coordinates, run_.write);
  }
  [[nodiscard]] VoxelIds labels(const sherd::Progress& progress) override;
  [[nodiscard]] std::uint64_t seed() const override { return run_.fracture.seed; }
  [[nodiscard]] const std::vector<sherd::Fragment>& measured(const sherd::Progress&) override;
  [[nodiscard]] const std::vector<sherd::Fragment>& sampled(const sherd::Progress&) override;
  [[nodiscard]] std::string smoothText() const override;
  [[nodiscard]] std::string unitedText() const override;
  [[nodiscard]] std::vector<std::string> guideWarnings() const override;
  [[nodiscard]] sherd::FinishedFracture finished(const sherd::Progress& progress) override;
  [[nodiscard]] sherd::RunOptions inherited() const override {
    return sherd::inheritedOptions(run_);
  }
  [[nodiscard]] SolidPtr solidOf(const sherd::FinishedFracture&) const override { return solid_; }
  [[nodiscard]] std::vector<int> parents() const override { return grown_.result.parents; }

  [[nodiscard]] const GivenOptions& given() const { return given_; }

  /// Writes the files that `write` names.
  ///   return  sentences about what may be lost, or was kept
  [[nodiscard]] std::vector<std::string> save(const std::string& folder, sherd::WriteOptions write,
                                              const sherd::Progress& progress);

 protected:
  [[nodiscard]] std::vector<sherd::Fragment> made(const sherd::Progress& progress) override;
  [[nodiscard]] std::vector<std::shared_ptr<std::vector<std::int32_t>>> facesOf(
      const std::vector<sherd::Fragment>& fragments) const override;
  [[nodiscard]] const sherd::FragmentSurfaces* surfaces(const sherd::Progress& progress) override;

 private:
  [[nodiscard]] sherd::SurfaceOptions surface(bool meshes) const;
  bool measureSurfaces(const sherd::Progress& progress);
  [[nodiscard]] sherd::FractureResult extractedCopy(const sherd::FractureOptions& options,
                                                    const sherd::Progress& progress) const;

  SolidPtr solid_;
  GivenOptions given_;
  sherd::RunOptions run_;
  sherd::GrownFracture grown_;  // guarded by making_; its fragments are those of sampled()
  const bool isAgain_;          // with exact surfaces
  bool isMeasured_ = false;
  std::optional<bool> isMerged_;  // once it is known, guarded by making_
  std::string smoothText_, unitedText_;
};

/// A fracture read from its folder.
class LoadedPieces : public Fracture {
 public:
  /// Reads the manifest.
  explicit LoadedPieces(const std::string& folder);

  [[nodiscard]] std::size_t count() const override { return manifest_.fragments.size(); }
  [[nodiscard]] sherd::GridFrame frame() const override { return frame_; }
  [[nodiscard]] glm::dvec3 offset() const override {
    return manifest_.offset.value_or(glm::dvec3(0.0));
  }
  [[nodiscard]] sherd::CoordinateSystem coordinates() const override {
    return manifest_.coordinates;
  }
  [[nodiscard]] VoxelIds labels(const sherd::Progress& progress) override;
  [[nodiscard]] std::uint64_t seed() const override { return manifest_.seed; }
  [[nodiscard]] const std::vector<sherd::Fragment>& measured(const sherd::Progress& p) override {
    return meshed(p);
  }

  [[nodiscard]] sherd::FinishedFracture finished(const sherd::Progress& progress) override;
  [[nodiscard]] sherd::RunOptions inherited() const override {
    return sherd::inheritedOptions(std::filesystem::path(file_));
  }
  [[nodiscard]] SolidPtr solidOf(const sherd::FinishedFracture& finished) const override;

  [[nodiscard]] const std::string& file() const { return file_; }

 protected:
  [[nodiscard]] std::vector<sherd::Fragment> made(const sherd::Progress& progress) override;
  [[nodiscard]] bool canBeMadeAgain() const override { return false; }  // files may change

 private:
  std::string file_;  // the manifest's path
  sherd::Manifest manifest_;
  sherd::GridFrame frame_;
  std::vector<std::vector<sherd::Contact>> contacts_;
};

/// Returns the options of a fracture whose fragments are broken again.
///   given  those that are not taken from the fracture
[[nodiscard]] GivenOptions optionsAgain(const Fracture& fracture, const GivenOptions& given);

/// Breaks fragments again.
///   given  all options, as optionsAgain returns them
[[nodiscard]] std::shared_ptr<GrownPieces> brokenAgain(Fracture& fracture,
                                                       const std::vector<int>& ids,
                                                       const GivenOptions& given,
                                                       const std::string& device,
                                                       const sherd::Progress& progress);

/// Breaks a solid several times by the same options but for pieces and seed, growing together.
[[nodiscard]] std::vector<std::shared_ptr<GrownPieces>> broken(
    const SolidPtr& solid, const GivenOptions& given,
    const std::vector<std::pair<int, std::uint64_t>>& piecesAndSeeds, const std::string& device,
    const sherd::Progress& progress);

}  // namespace pysherd
