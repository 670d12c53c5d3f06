// Writing a fracture's files.
#pragma once

#include <sherd/fracture.h>
#include <sherd/mesh_files.h>
#include <sherd/options.h>
#include <sherd/output_file.h>
#include <sherd/point_files.h>
#include <sherd/vdb_files.h>
#include <sherd/voxel_files.h>

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace sherd {

/// Writes the boundaries of all contacts (see boundaryLoops) as closed polylines in OBJ: an object
/// boundary_<id>_<id> for each pair of touching fragments, the lower id first.
///   throws  Error(output)
void writeBoundaries(const OutputFile& file, std::span<const Fragment> fragments);

/// Writes the contact graph for simulations as JSON in the schema of NVIDIA Blast: chunks (the
/// whole first, the fragments as its children) and bonds between fragments, each with area, normal
/// and centroid.
///   throws  Error(output)
void writeGraph(const OutputFile& file, std::span<const Fragment> fragments,
                const GridMetadata& metadata);

/// Writes the contact graph as a Houdini constraint network in the ASCII format `.geo`: a point at
/// each fragment's center of mass, with `name`, and an open polygon for each contact, with
/// constraint_name, constraint_type, restlength and strength (the contact's area).
///   throws  Error(output)
void writeConstraints(const OutputFile& file, std::span<const Fragment> fragments);

/// Writes the convex hull of a fragment's mesh as OBJ.
///   gap     distance between the hulls of two convex neighbors, world units
///   throws  Error(output); Error(input) the mesh is flat
void writeProxy(const OutputFile& file, const Fragment& fragment, const std::string& name,
                double gap);

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

}  // namespace sherd
