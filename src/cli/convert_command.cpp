// `sherd convert`: the same voxels in another format.
#include <sherd/error.h>
#include <sherd/voxel_files.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "cli/command.h"
#include "cli/fracture_options.h"
#include "cli/option_text.h"
#include "io/json_of.h"

namespace sherd::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct ConvertArguments {
  std::string in, out;
  std::string pad;
  double voxelSize = 0.0;  ///< 0: not given
  glm::dvec3 origin{0.0};
  bool json = false;
};

/// What was done, as JSON tells it, and what got lost.
struct Converted {
  Json told;
  std::vector<std::string> losses;
};

Converted convertVoxels(const ConvertArguments& arguments, VoxelFormat format) {
  PlacedVoxels voxels = readVoxels(arguments.in);
  if (arguments.voxelSize > 0.0) {
    voxels.place = VoxelPlace{{{arguments.origin}, arguments.voxelSize}, {0, 0, 0}};
  }
  if (arguments.pad == "cube") voxels = padded(voxels, Padding::atEnd);
  if (arguments.pad == "cube-centred") voxels = padded(voxels, Padding::centred);
  writeVoxels(arguments.out, voxels, format);
  return {{{"kind", "voxels"},
           {"dims", jsonOf(voxels.voxels.dims)},
           {"runs", voxels.voxels.runs.size()}},
          lossesOf(voxels, format)};
}

Converted convert(const ConvertArguments& arguments) {
  const std::optional<VoxelFormat> format = voxelFormatOf(arguments.out);
  if (!format) {
    throw Error(ErrorCode::usage, arguments.out +
                                      ": its extension names no format that is written; these "
                                      "are .rle .npy .npz .vox .qstack .bing");
  }
  return convertVoxels(arguments, *format);
}

void runConvert(const ConvertArguments& arguments) {
  const Converted done = convert(arguments);
  for (const std::string& loss : done.losses) {
    printMessage("sherd: warning: " + arguments.out + ": " + loss);
  }
  Json told = {{"schema", "sherd-report/1"},
               {"command", "convert"},
               {"source", arguments.in},
               {"file", arguments.out}};
  told.update(done.told);
  told["losses"] = done.losses;
  if (arguments.json) {
    return printResult(told.dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
  }
  printResult(arguments.out + ": " + told["kind"].get<std::string>() + " of " + arguments.in +
              "\n");
}

}  // namespace

void addConvertCommand(CLI::App& app, Action& run) {
  CLI::App* command =
      app.add_subcommand("convert", "Write voxels in another format, each by its extension");
  auto arguments = std::make_shared<ConvertArguments>();
  command->add_option("IN", arguments->in, "Voxels: .rle .npy .npz .vox .qstack .bing")->required();
  command->add_option("OUT", arguments->out, "The file to write; one that is there is replaced")
      ->required();
  const std::string group = "Voxels";
  command->add_option("--pad", arguments->pad, "Make the box a cube: zeros at its end, or round it")
      ->check(CLI::IsMember({"cube", "cube-centred"}))
      ->group(group);
  CLI::Option* voxelSize = command
                               ->add_option("--voxel-size", arguments->voxelSize,
                                            "Voxel size to tell in an .npz, in the mesh's unit")
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
          "Centre of the first voxel to tell in an .npz, in the mesh's unit")
      ->type_name("X,Y,Z")
      ->needs(voxelSize)
      ->group(group);
  voxelSize->needs("--origin");
  command->add_flag("--json", arguments->json, "Print one JSON object");
  command->callback([arguments, &run] { run = [arguments] { runConvert(*arguments); }; });
}

}  // namespace sherd::cli
