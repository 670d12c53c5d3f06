// The options of a fracture and of its files, and the table that lists them.
#pragma once

#include <sherd/files.h>
#include <sherd/fracture.h>
#include <sherd/points.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sherd {

/// The `.vdb` files that hold the fragments.
enum class VdbFiles {
  files,   ///< one per fragment
  single,  ///< fragments.vdb
  both,
};

/// Formats of scenes in Pixar's Universal Scene Description.
enum class UsdFormat {
  usda,  ///< text, beside its textures
  usdz,  ///< an archive with the text and the textures
};

/// The type of vertices in meshes, in the formats that hold doubles: `.ply` and text (`.obj`, STL).
enum class Precision {
  automatic,  ///< full of exact surfaces, whose slivers cross each other once they are rounded, and
              ///< where single would move vertices by more than kMostRoundingVoxels
  single,
  full,  ///< double: vertices of the input keep their bits, whatever its precision
};

/// Voxels by which single precision may move vertices without a warning.
inline constexpr double kMostRoundingVoxels = 0.01;

/// The files that a fracture writes in addition to `manifest.json`.
struct WriteOptions {
  bool labels = true;        ///< labels.rle, or other formats by voxelFormats
  bool vdb = true;           ///< level sets, by vdbFiles
  bool mesh = true;          ///< meshes/STEM_001.ply, and the input's textures
  bool preview = true;       ///< preview.png; of large solids from meshes no finer than its pixels
  bool seeds = false;        ///< seeds.json
  bool boundaries = false;   ///< boundaries.obj
  bool cost = false;         ///< cost.vdb, if the labels have costs
  bool solid = false;        ///< also the intact solid: fragments/STEM.vdb with `vdb`, and
                             ///< meshes/STEM.ply etc. with `mesh`
  bool scene = false;        ///< scene.glb: a node for each fragment, its origin the center of mass
  bool graph = false;        ///< graph.json and graph.geo
  bool viewer = false;       ///< viewer.html, see viewerOf
  bool usd = false;          ///< scene.usda, or other formats by usdFormats
  bool houdini = false;      ///< pieces.geo and graph.geo
  bool plainMeshes = false;  ///< only vertices and triangles in `.ply`, `.obj` and `.glb`
  bool proxy = false;        ///< proxies/STEM_001.obj, convex hulls

  VdbFiles vdbFiles = VdbFiles::files;  ///< fragments/STEM_001.vdb, fragments.vdb, or both
  VdbOptions vdbOptions{};
  double density = 1000.0;  ///< kilograms per cubic meter, above 0
  double proxyGap = 0.0;    ///< `gap` of writeProxy, at least 0

  std::vector<VoxelFormat> voxelFormats{VoxelFormat::rle};       ///< not empty, no duplicates
  std::vector<MeshFileFormat> meshFormats{MeshFileFormat::ply};  ///< not empty, no duplicates

  std::vector<UsdFormat> usdFormats{UsdFormat::usda};  ///< not empty, no duplicates
  bool usdVolumes = false;     ///< with `vdb`: scene.usda refers to the level sets
  double jointStrength = 1e5;  ///< newtons per square meter of a contact that break its joint in a
                               ///< scene or graph.geo, above 0

  PointOptions points{};     ///< points/STEM_001.ply if count > 0; `seed` must be 0: each
                             ///< fragment's is derived from the fracture's
  bool sharePoints = false;  ///< points.count is the total, distributed by the fragments' areas
  std::vector<PointFormat> pointFormats{PointFormat::ply};
  std::uint64_t samplingMemory = std::uint64_t{256}
                                 << 20;  ///< bytes that the points of several fragments take at
                                         ///< once; one fragment's may take more, see requireMemory
  DistanceOptions distances{};      ///< sdf/STEM_001.npz, and sdf/STEM.npz of the intact solid, if
                                    ///< count > 0; a `sigma` of 0 is the voxel size; `seed` as for
                                    ///< points
  std::size_t correspondences = 0;  ///< correspondences.npz: points per contact; 0: no file

  Precision precision = Precision::automatic;  ///< of meshes, proxies and boundaries
  bool sourceFaces = false;  ///< the face of the input on which each face of meshes/STEM_001.ply
                             ///< lies, see sourceFaces; not of volumes

  /// What positions of the files lack to be the input's, of an object that recentered() moved:
  /// recorded in manifest.json and seeds.json.
  std::optional<glm::dvec3> offset{};

  /// The mesh's length unit, above 0, and its axis that points up, 'x', 'y' or 'z', instead of
  /// those of SourceMesh::coordinates.
  std::optional<double> metersPerUnit{};
  std::optional<char> up{};

  bool needsLevelSets() const { return vdb || vdbOptions.fog; }  ///< Fragment::surface

  /// Whether a file is written that needs Fragment::mesh.  Points do not.
  bool needsMeshes() const {
    return mesh || preview || boundaries || scene || usd || graph || houdini || viewer || proxy ||
           distances.count > 0 || correspondences > 0;
  }

  /// Whether a file is written that needs the meshes, or the level sets, of all fragments at once.
  bool needsAllMeshes() const {
    return boundaries || scene || usd || houdini || viewer || distances.count > 0 ||
           correspondences > 0 || (needsMeshes() && points.count > 0 && sharePoints);
  }
  bool needsAllLevelSets() const { return vdb && vdbFiles != VdbFiles::files; }
};

/// Returns what a mesh's coordinates mean, with what options say of it.
[[nodiscard]] CoordinateSystem coordinatesOf(const CoordinateSystem& read,
                                             const WriteOptions& write);

/// Returns WriteOptions::samplingMemory for a limit on all memory.
[[nodiscard]] inline std::uint64_t samplingMemoryOf(std::uint64_t limit) {
  return std::clamp<std::uint64_t>(limit / 8, std::uint64_t{64} << 20, std::uint64_t{1} << 30);
}

/// All options of a fracture: how it breaks, and what it writes.
struct RunOptions {
  FractureOptions fracture{.surface = {.surface = Surface::automatic}};
  VolumeOptions volume{};  ///< how an input that is a volume is read
  WriteOptions write{};
  bool recenter = false;  ///< the object is moved so that its box's center is the origin, see
                          ///< recentered()
};

/// Returns the center of a mesh's box, or of a solid's inside voxels.
[[nodiscard]] glm::dvec3 boxCenter(const TriangleMesh& mesh);
[[nodiscard]] glm::dvec3 boxCenter(const Solid& solid);

/// Returns an object moved by a vector.  By its center to the origin, that is exact along axes on
/// which its box is at least half its length away from 0, else within 2^-54 of that length.
///   solid  of a level set: without a mesh or a region
[[nodiscard]] TriangleMesh moved(TriangleMesh mesh, const glm::dvec3& by);
[[nodiscard]] Solid moved(Solid solid, const glm::dvec3& by);

/// Returns options for an object that was moved: what they place in space, which are impacts, given
/// seeds, guides and a density, is moved with it.
[[nodiscard]] FractureOptions moved(FractureOptions options, const glm::dvec3& by);

/// Returns options for an object that was moved by the negative of `offset`.
[[nodiscard]] RunOptions recentered(RunOptions options, const glm::dvec3& offset);

/// The types of options' values.
enum class OptionType {
  flag,     ///< "true" or "false"
  whole,    ///< a whole number
  number,   ///< a number
  length,   ///< a number of voxels, or a percentage of the longest side: "0.8%"
  choice,   ///< one of OptionValue::choices
  choices,  ///< some of them, separated by commas, each once
  wholes,   ///< whole numbers, separated by commas
  numbers,  ///< numbers, separated by commas
  text,     ///< anything else, described by OptionValue::range
};

/// How an option is read from text and written as text.  `set` accepts what `text` returns.
template <class Target>
struct OptionValue {
  OptionType type = OptionType::text;
  std::string range;                 ///< "0..1", "> 0", "K|Kn"; empty for flags and choices
  std::vector<std::string> choices;  ///< of a choice, choices, or the only whole numbers
  /// Sets the option.  Throws Error(usage) "'TEXT' is not ..." for any other text.
  std::function<void(Target& options, const std::string& text)> set;
  std::function<std::string(const Target& options)> text;
};

/// One option: a row of a table.
template <class Target>
struct OptionRow {
  const char* name;   ///< on the command line after two dashes, in configuration files, in `draw`
  const char* group;  ///< heading of the help; empty: none
  OptionValue<Target> value;
  const char* help;          ///< one sentence without its full stop
  const char* details = "";  ///< the same at length, in Markdown; empty: help says all
  const char* key = "";      ///< place in a manifest's `options`, such as "erode.size"; empty: none
  const char* elsewhere = "";  ///< place in a manifest of an option without a key: "files"
  bool (*recorded)(const Target&) = nullptr;  ///< whether the manifest has it; null: always
  const char* excludes = "";                  ///< name of an option that cannot be given too
  const char* needs = "";                     ///< name of an option that must be given too
  bool hidden = false;                        ///< a field that other options set: only in manifests
  bool repeats = false;    ///< may be given several times: each adds to the others
  bool single = false;     ///< of single fractures: a dataset sets it itself, or has none
  bool drawn = false;      ///< a dataset may draw its value anew for each fracture
  const char* unit = "";   ///< of numbers: "voxels", "world units"; empty: none
  const char* alias = "";  ///< another name of the option for a single fracture
};

using FractureOptionRow = OptionRow<RunOptions>;

/// Returns all options of a fracture.  The command line, configuration files, manifests, what a
/// dataset draws, and the tables of docs/cli.md are made from these rows.
[[nodiscard]] std::span<const FractureOptionRow> fractureOptionTable();

/// Returns the row with a name that is not hidden, or null.
[[nodiscard]] const FractureOptionRow* fractureOption(std::string_view name);

/// An option whose value is drawn for each fracture of a dataset: from a range, or from choices.
struct DrawnOption {
  std::string name;                  ///< of a row that may be drawn
  std::string low, high;             ///< ends of a range
  std::vector<std::string> choices;  ///< empty for a range

  /// Returns "low..high" or "a|b|c".
  [[nodiscard]] std::string text() const;

  /// Returns the value for one fracture: a choice, a whole number where both ends of the range are
  /// written without a decimal point, else a number with six digits.
  ///   seed  of the fracture.  A value does not depend on which other options are drawn
  [[nodiscard]] std::string valueFor(std::uint64_t seed) const;
};

/// Returns the drawn option for a row's name and a text, or nullopt if the text is a single value
/// or the row cannot be drawn.
[[nodiscard]] std::optional<DrawnOption> drawnOption(std::string_view name,
                                                     const std::string& text);

/// Returns what a preset draws for each fracture by its seed, beside the options that it sets:
/// ranges of `roughness`, `missing`, `mismatch` and `scan-noise` for "training", nothing for
/// others.
///   options  as chosen: what contradicts them is not drawn, and with a material no roughness
///   isGiven  whether the user chose a value by a row's name: it is not drawn
[[nodiscard]] std::vector<DrawnOption> presetDraws(
    std::string_view preset, const RunOptions& options,
    const std::function<bool(std::string_view name)>& isGiven);

/// Checks both ends of a range, or all choices.
///   throws  Error(usage) "'TEXT' is not ..."
void checkDrawn(const DrawnOption& drawn, const RunOptions& options);

/// What idleOptions asks beside the values of options; names are those of rows.
struct OptionUse {
  std::function<bool(std::string_view name)> isGiven;         ///< whether the user chose the value
  std::function<std::string(std::string_view name)> spelled;  ///< in sentences, as "--pieces"
  std::function<bool(std::string_view name)> isDrawn{};  ///< of a dataset's options; null: none is
  std::string input{};     ///< the file that is broken; empty: there is none, or several
  bool isDataset = false;  ///< many fractures
};

/// Checks the given options against each other.
///   return  a sentence for each that does nothing: "--metric does nothing without --growth ..."
///   throws  Error(usage) two contradict each other, or one contradicts the kind of the input
[[nodiscard]] std::vector<std::string> idleOptions(const RunOptions& options, const OptionUse& use);

/// Returns a sentence for each given option that does nothing with a volume that was read.
[[nodiscard]] std::vector<std::string> idleOptions(const Volume& volume, const OptionUse& use);

}  // namespace sherd
