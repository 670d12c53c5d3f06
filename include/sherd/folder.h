// A fracture's folder: writing it, and reading it back.
#pragma once

#include <sherd/evaluate.h>
#include <sherd/files.h>
#include <sherd/fracture.h>
#include <sherd/options.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace sherd {

/// Returns the options, with arrival costs and level sets enabled exactly if the files need them.
[[nodiscard]] FractureOptions optionsFor(FractureOptions options, const WriteOptions& write);

/// Checks the options.  Call this before long work.
///   throws  Error(usage) correspondences of fragments that do not share their surfaces; STL both
///           binary and as text
void checkWriteOptions(const WriteOptions& write, const FractureOptions& options);

/// Checks that writeFracture can write into a folder: it must be writable, and absent, empty or an
/// earlier fracture's.  Call this before long work.  The only change it makes: a fracture that a
/// killed run left half replaced is restored to the earlier one.
///   throws  Error(output) the folder holds something else, or cannot be written
void checkFractureFolder(const std::filesystem::path& folder);

/// The result of writeFracture.
struct WrittenFolder {
  std::filesystem::path manifest;
  std::vector<std::string> warnings;  ///< a sentence about files that the earlier manifest lists
                                      ///< but that are kept, as no fracture's file has such a name
};

/// Writes a fracture into a folder that checkFractureFolder accepts.  Files that the earlier
/// manifest lists are replaced if they have names that this function uses; all others stay.  Files
/// are written to a hidden folder and renamed, `manifest.json` last: without it the folder is
/// unfinished.  On failure the folder is as before; after a kill it is restored when
/// checkFractureFolder or a reader of fractures opens it.
///   throws  Error(usage) correspondences of fragments that do not share their surfaces; what
///           samplePoints and sampleDistances throw; Error(output) the folder holds something else,
///           cannot be written, or the disk is full
WrittenFolder writeFracture(const std::filesystem::path& folder, const SourceMesh& source,
                            const FractureOptions& options, const FractureResult& result,
                            const WriteOptions& write = {}, const Progress* progress = nullptr);

/// The result of fractureInto.
struct WrittenFracture {
  FractureResult result;  ///< fragments without the members that fractureInto frees
  WrittenFolder folder;
};

/// Breaks a mesh into a folder.  The files are those of `fracture` followed by `writeFracture`, but
/// fragments are written in batches while they are made, and their level sets and meshes are freed
/// then unless WriteOptions::needsAllLevelSets or needsAllMeshes keeps them.  Where both are freed,
/// large solids take a quarter to a third less memory (docs/performance.md).
///   return  the result without what was freed: Fragment::surface; mesh and neighbor
///   throws  what fracture and writeFracture throw
[[nodiscard]] WrittenFracture fractureInto(const std::filesystem::path& folder,
                                           const SourceMesh& source, const FractureOptions& options,
                                           Device& device, const WriteOptions& write = {},
                                           const Progress* progress = nullptr);

/// Reads a fracture from its `manifest.json`, its labels and the fragments' `.vdb` files.
///   throws  Error(input) not a fracture's manifest, a fracture written without labels or vdb, a
///           file that is absent, damaged or inconsistent with the others
[[nodiscard]] FinishedFracture readFracture(const std::filesystem::path& manifest);

/// Reads the fragments of a folder: those that its manifest.json lists, else every file with an
/// extension of readMesh, numbered from 1 in natural order: piece_2 before piece_10.
///   throws  Error(input) `folder` is not a folder, or has neither; the manifest is damaged; a mesh
///           cannot be read, or all meshes together take more memory than `options` allow;
///           Error(cancelled)
[[nodiscard]] FragmentSet readFragments(const std::filesystem::path& folder,
                                        const ReadOptions& options = {},
                                        const Progress* progress = nullptr);

/// Reads fragments from a fracture's folder or manifest, or from a folder of meshes as
/// readFragments does; else the mesh of a file, or the level sets of a `.vdb` file.  Fragments of a
/// fracture without mesh files are meshed from their level sets.
///   return  id, mesh, mass, and neighbor where it is known
///   throws  Error(input) nothing can be rendered, a file is damaged, or the meshes take more
///   memory
///           than `options` allow
[[nodiscard]] std::vector<Fragment> readPieces(const std::filesystem::path& path,
                                               const ReadOptions& options = {});

}  // namespace sherd
