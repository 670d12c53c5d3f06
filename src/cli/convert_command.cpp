// `sherd convert`: writes voxels, a mesh or points in another format.
#include <sherd/error.h>
#include <sherd/files.h>
#include <sherd/folder.h>
#include <sherd/mesh.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "base/memory.h"
#include "base/text/json_of.h"
#include "base/text/lower_case.h"
#include "base/text/option_names.h"
#include "base/text/option_text.h"
#include "base/text/printable.h"
#include "cli/arguments/option_text.h"
#include "cli/terminal/command.h"
#include "cli/terminal/held_files.h"
#include "cli/terminal/interrupts.h"
#include "cli/terminal/output_path.h"

namespace sherd::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct ConvertArguments {
  std::string in, out;
  std::string pad;
  double voxelSize = 0.0;  ///< 0: not given
  glm::dvec3 origin{0.0};
  bool ascii = false;  ///< .stl files as text
  bool json = false;
};

/// Fields of the JSON report, and a sentence for each thing that the format cannot hold.
struct Converted {
  Json fields;
  std::vector<std::string> losses;
};

Converted convertVoxels(const ConvertArguments& arguments, HeldFiles& files, VoxelFormat format) {
  PlacedVoxels voxels = readVoxels(arguments.in, {.maxMemory = freeMemory()});
  if (arguments.voxelSize > 0.0) {
    voxels.transform = VoxelTransform{{arguments.origin, arguments.voxelSize}, {0, 0, 0}};
  }
  if (arguments.pad == "cube") voxels = padded(voxels, Padding::atEnd, arguments.in);
  if (arguments.pad == "cube-centered") voxels = padded(voxels, Padding::centered, arguments.in);
  writeVoxels({files, arguments.out}, voxels, format);
  return {{{"kind", "voxels"},
           {"dims", jsonOf(voxels.voxels.dims)},
           {"runs", voxels.voxels.runs.size()}},
          lossesOf(voxels, format)};
}

Converted convertMesh(const ConvertArguments& arguments, HeldFiles& files, MeshFileFormat format) {
  const SourceMesh source =
      readMesh(arguments.in, {.maxMemory = freeMemory()}, &untilInterrupted());
  if (format == MeshFileFormat::stl && arguments.ascii) format = MeshFileFormat::stlText;
  writeMeshFile(files, arguments.out, source, format);
  return {{{"kind", "mesh"},
           {"vertices", source.mesh.vertices.size()},
           {"triangles", source.mesh.triangles.size()}},
          lossesOf(source, format)};
}

Converted convertPoints(const ConvertArguments& arguments, HeldFiles& files, PointFormat format) {
  const SurfacePoints points = readPoints(arguments.in, {.maxMemory = freeMemory()});
  writePoints({files, arguments.out}, points, format);
  return {{{"kind", "points"}, {"points", points.positions.size()}}, lossesOf(points, format)};
}

// Returns a sentence for each option that does nothing.
std::vector<std::string> idleConversionOptions(const ConvertArguments& arguments,
                                               const std::string& kind) {
  std::vector<std::string> sentences;
  if (kind != "voxels") {
    const std::string with = kind == "mesh" ? " with a mesh" : " with " + kind;
    if (!arguments.pad.empty()) sentences.push_back("--pad does nothing" + with);
    if (arguments.voxelSize > 0.0) {
      sentences.push_back("--voxel-size and --origin do nothing" + with);
    }
  }
  if (arguments.ascii && lowerCase(fs::path(arguments.out).extension().string()) != ".stl") {
    sentences.emplace_back("--ascii does nothing without a file that ends in .stl");
  }
  return sentences;
}

// Refuses an OUT whose format cannot hold what IN holds.
[[noreturn]] void refuseFormat(const ConvertArguments& arguments, const std::string& what,
                               const std::string& endings) {
  throw Error(ErrorCode::usage, arguments.out + ": " + arguments.in + " holds " + what +
                                    ", which are written as " + endings);
}

std::optional<MeshFileFormat> meshFormatOf(const fs::path& file) {
  const std::string extension = lowerCase(file.extension().string());
  for (std::size_t i = 0; i < std::size(names::kMeshFileFormat); ++i) {
    if (static_cast<MeshFileFormat>(i) != MeshFileFormat::stlText &&
        extension == std::string(".") + names::kMeshFileFormat[i]) {
      return static_cast<MeshFileFormat>(i);
    }
  }
  return {};
}

Converted convert(const ConvertArguments& arguments, HeldFiles& files) {
  switch (kindOf(arguments.in, {.maxMemory = freeMemory()})) {
    case FileKind::voxels: {
      const auto format = voxelFormatOf(arguments.out);
      if (format) return convertVoxels(arguments, files, *format);
      refuseFormat(arguments, "voxels", ".rle .npy .npz .vox .qstack .bing");
    }
    case FileKind::mesh: {
      const auto format = meshFormatOf(arguments.out);
      if (format) return convertMesh(arguments, files, *format);
      refuseFormat(arguments, "triangles", ".ply .obj .glb .stl .binm");
    }
    case FileKind::points: {
      const auto format = pointFormatOf(arguments.out);
      if (format) return convertPoints(arguments, files, *format);
      refuseFormat(arguments, "points", ".ply .xyz .npz .binp");
    }
    case FileKind::other:
      break;
  }
  throw Error(ErrorCode::input, arguments.in +
                                    ": holds neither voxels, a mesh nor points; an .npz needs "
                                    "'labels' or 'positions'");
}

void runConvert(const ConvertArguments& arguments) {
  requireNoInput("OUT", arguments.out);
  setInterruptedState(arguments.out + " is as it was before");
  HeldFiles files;
  const Converted done = convert(arguments, files);
  for (const std::string& loss : done.losses) {
    printMessage("sherd: warning: " + arguments.out + ": " + loss);
  }
  for (const std::string& sentence : idleConversionOptions(arguments, done.fields.at("kind"))) {
    printMessage("sherd: warning: " + sentence);
  }
  Json report = {{"schema", "sherd-report/1"},
                 {"command", "convert"},
                 {"source", arguments.in},
                 {"file", arguments.out}};
  report.update(done.fields);
  report["losses"] = done.losses;
  const std::string result =
      arguments.json ? report.dump(1, ' ', false, Json::error_handler_t::replace)
                     : printable(arguments.out + ": " + report["kind"].get<std::string>() + " of " +
                                 arguments.in);
  finish(files, [&] { printResult(result + "\n"); });
}

}  // namespace

void addConvertCommand(CLI::App& app, Action& run) {
  CLI::App* command = app.add_subcommand(
      "convert", "Write voxels, a mesh or points in another format, each by its extension");
  auto arguments = std::make_shared<ConvertArguments>();
  command
      ->add_option(
          "IN", arguments->in,
          "Voxels (.rle .npy .npz .vox .qstack .bing), a mesh, or points (.ply .xyz .npz .binp)")
      ->required();
  command->add_option("OUT", arguments->out, "The file to write; an existing one is replaced")
      ->required();
  const std::string group = "Voxels";
  command
      ->add_option("--pad", arguments->pad,
                   "Pad the box to a cube: zeros at its end, or on all sides")
      ->check(CLI::IsMember({"cube", "cube-centered"}))
      ->group(group);
  CLI::Option* voxelSize = command
                               ->add_option("--voxel-size", arguments->voxelSize,
                                            "Voxel size to record in an .npz, in the mesh's unit")
                               ->check(aboveZero())
                               ->group(group);
  command
      ->add_option_function<std::string>(
          "--origin",
          [arguments](const std::string& text) {
            const auto numbers = numbersIn(split(text));
            if (!numbers || numbers->size() != 3) refuse("--origin", text, "three numbers X,Y,Z");
            arguments->origin = {(*numbers)[0], (*numbers)[1], (*numbers)[2]};
          },
          "Center of the first voxel to record in an .npz, in the mesh's unit")
      ->type_name("X,Y,Z")
      ->needs(voxelSize)
      ->group(group);
  voxelSize->needs("--origin");
  command->add_flag("--ascii", arguments->ascii, "Write .stl as text")->group("Meshes");
  command->add_flag("--json", arguments->json, "Print one JSON object");
  command->callback([arguments, &run] { run = [arguments] { runConvert(*arguments); }; });
}

}  // namespace sherd::cli
