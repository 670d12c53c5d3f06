// `sherd render`: images of fragments.
#include <sherd/error.h>
#include <sherd/files.h>
#include <sherd/folder.h>
#include <sherd/render.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <optional>

#include "base/memory.h"
#include "base/text/lower_case.h"
#include "base/text/option_text.h"
#include "cli/arguments/option_text.h"
#include "cli/terminal/command.h"
#include "cli/terminal/held_files.h"
#include "cli/terminal/interrupts.h"
#include "cli/terminal/output_path.h"

namespace sherd::cli {
namespace {

namespace fs = std::filesystem;

struct NamedView {
  const char* name;
  double azimuth, elevation;
};
constexpr NamedView kViews[] = {{"front", 0, 0},          {"right", 90, 0}, {"back", 180, 0},
                                {"left", 270, 0},         {"top", 0, 90},   {"bottom", 0, -90},
                                {"three-quarter", 35, 20}};

struct RenderArguments {
  std::vector<std::string> paths;
  std::string output;
  RenderOptions options;
  std::string up = "auto";
  int turntable = 0;  ///< images in a full rotation; 0: one image, not numbered
  int threads = 0;    ///< 0: all cores
};

void parseView(const std::string& text, RenderOptions& options) {
  for (const NamedView& view : kViews) {
    if (text != view.name) continue;
    options.azimuth = view.azimuth;
    options.elevation = view.elevation;
    return;
  }
  const std::vector<std::string> parts = split(text);
  const auto numbers = numbersIn(parts);
  if (!numbers || numbers->size() != 2 || std::abs((*numbers)[1]) > 90.0) {
    refuse("--view", text,
           "front, right, back, left, top, bottom, three-quarter, or AZIMUTH,ELEVATION in degrees");
  }
  options.azimuth = (*numbers)[0];
  options.elevation = (*numbers)[1];
}

void parseSize(const std::string& text, RenderOptions& options) {
  const std::size_t x = std::min(text.find('x'), text.size());
  const std::vector<std::string> sides{text.substr(0, x),
                                       text.substr(std::min(x + 1, text.size()))};
  const auto numbers = numbersIn(sides);
  const auto good = [](double side) {
    return side >= 16.0 && side <= 16384.0 && side == std::floor(side);
  };
  if (!numbers || !good((*numbers)[0]) || !good((*numbers)[1])) {
    refuse("--size", text, "WIDTHxHEIGHT, each 16 to 16384 pixels, as 1280x720");
  }
  options.width = static_cast<int>((*numbers)[0]);
  options.height = static_cast<int>((*numbers)[1]);
}

// Returns x_007.png for x.png.
fs::path numbered(const fs::path& file, std::size_t number, std::size_t count) {
  const std::string name = fragmentName(file.stem().string(), number, count);
  return file.parent_path() / (name + file.extension().string());
}

// Reads what is shown together; of several paths the fragments are numbered one after another.
Pieces readAll(const std::vector<std::string>& paths) {
  Pieces all = readPieces(paths.front(), {.maxMemory = freeMemory()});
  for (std::size_t i = 1; i < paths.size(); ++i) {
    Pieces more = readPieces(paths[i], {.maxMemory = freeMemory()});
    std::ranges::move(more.fragments, std::back_inserter(all.fragments));
  }
  if (paths.size() == 1) return all;
  int id = 0;
  for (Fragment& fragment : all.fragments) fragment.id = ++id;
  return all;
}

void runRender(RenderArguments& arguments) {
  std::optional<tbb::global_control> threads;
  if (arguments.threads > 0) {
    threads.emplace(tbb::global_control::max_allowed_parallelism,
                    static_cast<std::size_t>(arguments.threads));
  }
  const fs::path output = arguments.output;
  setInterruptedState(arguments.output + " is as it was before");
  const std::string extension = lowerCase(output.extension().string());
  if (extension != ".png" && extension != ".exr") {
    throw Error(ErrorCode::usage,
                "--output: '" + arguments.output + "' ends neither in .png nor .exr");
  }
  RenderOptions options = arguments.options;
  const auto count = static_cast<std::size_t>(std::max(1, arguments.turntable));
  const auto file = [&](std::size_t i) {
    return arguments.turntable > 0 ? numbered(output, i + 1, count) : output;
  };
  for (std::size_t i = 0; i < count; ++i) requireNoInput("--output", file(i));
  const Pieces pieces = readAll(arguments.paths);
  const std::vector<Fragment>& fragments = pieces.fragments;
  for (const int id : options.focus) {
    const auto hasId = [id](const Fragment& fragment) { return fragment.id == id; };
    if (std::ranges::none_of(fragments, hasId)) {
      throw Error(ErrorCode::usage, "--focus: there is no fragment " + std::to_string(id) +
                                        " to be shown, there are " +
                                        std::to_string(fragments.size()));
    }
  }
  options.up = arguments.up == "auto" ? pieces.coordinates.up : arguments.up.front();
  HeldFiles files;
  for (std::size_t i = 0; i < count; ++i) {
    options.azimuth =
        arguments.options.azimuth + 360.0 * static_cast<double>(i) / static_cast<double>(count);
    if (extension == ".png") {
      writePng({files, file(i)}, renderFragments(fragments, options, &untilInterrupted()));
    } else {
      writeExr({files, file(i)}, renderAovs(fragments, options, &untilInterrupted()));
    }
  }
  finish(files, [] {});
}

}  // namespace

void addRenderCommand(CLI::App& app, Action& run) {
  CLI::App* command =
      app.add_subcommand("render", "Render a fracture, a mesh or a level set as .png or .exr");
  auto arguments = std::make_shared<RenderArguments>();
  command
      ->add_option("PATH", arguments->paths,
                   "A fracture's folder, a folder of meshes, a mesh, or a .vdb file; several are "
                   "shown together")
      ->required();
  command
      ->add_option("-o,--output", arguments->output,
                   "The image: .png, or .exr with AOVs for compositing")
      ->type_name("FILE")
      ->required();
  command
      ->add_option_function<std::string>(
          "--view", [arguments](const std::string& text) { parseView(text, arguments->options); },
          "front, right, back, left, top, bottom, three-quarter, or AZIMUTH,ELEVATION in degrees")
      ->type_name("VIEW")
      ->default_str("three-quarter");
  command
      ->add_option("--explode", arguments->options.explode,
                   "How far fragments move apart, as a share of their distance to the center")
      ->check(numberBetween(0.0, 100.0, "0..100"))
      ->capture_default_str();
  command
      ->add_option("--focus", arguments->options.focus,
                   "Ids of fragments that fill the image, with what lies before and behind them; "
                   "of several PATHs ids count through all")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->transform(wholeNumber(1, kMaxFragments))
      ->type_name("ID,...");
  command
      ->add_option("--zoom", arguments->options.zoom,
                   "How many times larger the image shows its middle")
      ->check(numberBetween(0.01, 1000.0, "0.01..1000"))
      ->capture_default_str();
  command
      ->add_option_function<std::string>(
          "--size", [arguments](const std::string& text) { parseSize(text, arguments->options); },
          "Width and height in pixels")
      ->type_name("WxH")
      ->default_str("1280x720");
  command
      ->add_option(
          "--turntable", arguments->turntable,
          "Number of images in a full rotation, x_001.png and so on; 0: one image, not numbered")
      ->transform(wholeNumber(0, 100'000))
      ->capture_default_str();
  command
      ->add_option("--up", arguments->up,
                   "The mesh's axis that points up; auto: as the fracture or the file says, "
                   "else z in .stl, .off and .3mf, y in others")
      ->check(CLI::IsMember({"auto", "x", "y", "z"}))
      ->default_str("auto");
  command->add_option("--threads", arguments->threads, "Threads; default all cores")
      ->transform(wholeNumber(1, 4096));
  command->callback([arguments, &run] { run = [arguments] { runRender(*arguments); }; });
}

}  // namespace sherd::cli
