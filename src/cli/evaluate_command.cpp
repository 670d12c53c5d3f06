// `sherd evaluate`: figures that tell how good a finished fracture is.
#include <sherd/error.h>
#include <sherd/evaluate.h>
#include <sherd/mesh.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>

#include "cli/command.h"
#include "io/manifest.h"

namespace sherd::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct EvaluateArguments {
  std::string folder;
  std::size_t samples = 5000;
  std::uint64_t seed = 0;
  bool json = false;
};

/// One fragment, as the manifest tells it; and measured, where its mesh was written.
struct Piece {
  int id = 0;
  double share = 0.0;
  double volume = 0.0;
  double area = 0.0;
  double fractureArea = 0.0;
  std::size_t contacts = 0;
  std::string mesh;  ///< relative to the folder, or empty
  std::optional<Convexity> convexity;
};

/// The whole fracture in figures.
struct Evaluation {
  std::string source;
  std::uint64_t seed = 0;
  std::vector<Piece> pieces;  ///< [>= 1]
  std::size_t contacts = 0;   ///< pairs of fragments that touch
  double volume = 0.0;
  double area = 0.0;
  double fractureArea = 0.0;
  double smallestShare = 0.0;
  double largestShare = 0.0;
  double effectiveFragments = 0.0;
  std::optional<double> convexity;      ///< mean over the fragments
  std::optional<double> standardError;  ///< of that mean, as of a sample of fragments

  double contactsPerFragment() const {
    return 2.0 * static_cast<double>(contacts) / static_cast<double>(pieces.size());
  }
};

// ---- Reading.  A manifest is anybody's text: what it lacks is told, not crashed on.

[[noreturn]] void refuse(const fs::path& manifest, const std::string& why) {
  throw Error(ErrorCode::input, manifest.string() + ": is damaged: " + why);
}

Piece pieceOf(const nlohmann::json& fragment) {
  return {.id = fragment.at("id").get<int>(),
          .share = fragment.at("share").get<double>(),
          .volume = fragment.at("volume").get<double>(),
          .area = fragment.at("area").get<double>(),
          .fractureArea = fragment.at("fracture_area").get<double>(),
          .contacts = fragment.at("contacts").size(),
          .mesh = fragment.at("files").value("mesh", std::string()),
          .convexity = {}};
}

Evaluation readFracture(const fs::path& file) {
  const nlohmann::json manifest = needManifest(file);
  const std::optional<std::vector<std::string>> listed = listedFiles(manifest);
  if (!listed) refuse(file, "its list of files is absent or leaves the folder");
  Evaluation result;
  try {
    result.source = manifest.at("source").at("file").get<std::string>();
    result.seed = manifest.at("options").at("seed").get<std::uint64_t>();
    for (const nlohmann::json& fragment : manifest.at("fragments")) {
      result.pieces.push_back(pieceOf(fragment));
    }
  } catch (const nlohmann::json::exception& e) {
    refuse(file, e.what());
  }
  if (result.pieces.empty()) refuse(file, "it has no fragment");
  for (const Piece& piece : result.pieces) {
    const bool known = std::find(listed->begin(), listed->end(), piece.mesh) != listed->end();
    if (!piece.mesh.empty() && !known) {
      refuse(file, "fragment " + std::to_string(piece.id) + " has a mesh that is not in its files");
    }
  }
  return result;
}

// ---- Figures

void measure(Piece& piece, const EvaluateArguments& arguments) {
  if (piece.mesh.empty()) return;
  const fs::path file = fs::path(arguments.folder) / piece.mesh;
  const TriangleMesh mesh = readMesh(file).mesh;
  try {
    piece.convexity = convexity(mesh, arguments.samples, arguments.seed);
  } catch (const Error& e) {
    throw Error(e.code(), file.string() + ": " + e.what());
  }
}

void setMeanConvexity(Evaluation& evaluation) {
  std::vector<double> values;
  for (const Piece& piece : evaluation.pieces) {
    if (piece.convexity) values.push_back(piece.convexity->value);
  }
  if (values.empty()) return;
  const double count = static_cast<double>(values.size());
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / count;
  evaluation.convexity = mean;
  if (values.size() < 2) return;
  double squares = 0.0;
  for (const double value : values) squares += (value - mean) * (value - mean);
  evaluation.standardError = std::sqrt(squares / (count - 1.0) / count);
}

Evaluation evaluate(const EvaluateArguments& arguments) {
  if (!fs::is_directory(arguments.folder)) {
    throw Error(ErrorCode::input, arguments.folder + ": no such folder; a fracture's is needed");
  }
  Evaluation result = readFracture(fs::path(arguments.folder) / "manifest.json");
  std::vector<double> shares;
  std::size_t ends = 0;
  for (Piece& piece : result.pieces) {
    measure(piece, arguments);
    shares.push_back(piece.share);
    ends += piece.contacts;
    result.volume += piece.volume;
    result.area += piece.area;
    result.fractureArea += piece.fractureArea;
  }
  result.contacts = ends / 2;  // each is told of by both its fragments
  const auto [smallest, largest] = std::minmax_element(shares.begin(), shares.end());
  result.smallestShare = *smallest;
  result.largestShare = *largest;
  result.effectiveFragments = effectiveCount(shares);
  setMeanConvexity(result);
  return result;
}

// ---- Telling

double ratio(double part, double whole) { return whole > 0.0 ? part / whole : 0.0; }

Json jsonOf(const std::optional<double>& value) { return value ? Json(*value) : Json(); }

Json pieceJson(const Piece& piece) {
  Json json = {{"id", piece.id},
               {"share", piece.share},
               {"volume", piece.volume},
               {"fracture_area_share", ratio(piece.fractureArea, piece.area)},
               {"contacts", piece.contacts},
               {"convexity", nullptr}};
  if (piece.convexity) {
    json["convexity"] = piece.convexity->value;
    json["distance_deviation"] = piece.convexity->standardDeviation;
    json["samples"] = piece.convexity->samples;
  }
  return json;
}

std::string asJson(const EvaluateArguments& arguments, const Evaluation& evaluation) {
  Json json = {{"schema", "sherd-report/1"},
               {"command", "evaluate"},
               {"folder", arguments.folder},
               {"source", evaluation.source},
               {"seed", evaluation.seed},
               {"pieces", evaluation.pieces.size()},
               {"effective_pieces", evaluation.effectiveFragments},
               {"smallest_share", evaluation.smallestShare},
               {"largest_share", evaluation.largestShare},
               {"volume", evaluation.volume},
               {"contacts", evaluation.contacts},
               {"contacts_per_fragment", evaluation.contactsPerFragment()},
               {"fracture_area_share", ratio(evaluation.fractureArea, evaluation.area)},
               {"convexity", jsonOf(evaluation.convexity)},
               {"convexity_standard_error", jsonOf(evaluation.standardError)},
               {"fragments", Json::array()}};
  for (const Piece& piece : evaluation.pieces) json["fragments"].push_back(pieceJson(piece));
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

template <class... Values>
std::string format(const char* pattern, Values... values) {
  char text[256];
  std::snprintf(text, sizeof text, pattern, values...);
  return text;
}

std::string asText(const EvaluateArguments& arguments, const Evaluation& evaluation) {
  const std::size_t count = evaluation.pieces.size();
  std::string text = arguments.folder + ": " + std::to_string(count) +
                     (count == 1 ? " fragment of " : " fragments of ") + evaluation.source +
                     ", seed " + std::to_string(evaluation.seed) + "\n\n";
  text += "   id    share        volume  fracture area  contacts  convexity\n";
  for (const Piece& piece : evaluation.pieces) {
    text += format("%5d %6.2f %% %13.6g %12.2f %% %9zu", piece.id, 100.0 * piece.share,
                   piece.volume, 100.0 * ratio(piece.fractureArea, piece.area), piece.contacts);
    text += piece.convexity ? format(" %10.4f\n", piece.convexity->value) : "          -\n";
  }
  text += format("\neffective fragments    %.2f of %zu\n", evaluation.effectiveFragments, count);
  text += format("shares                 %.2f %% to %.2f %%\n", 100.0 * evaluation.smallestShare,
                 100.0 * evaluation.largestShare);
  text += format("volume                 %.6g\n", evaluation.volume);
  text += format("fracture area          %.2f %% of all surface\n",
                 100.0 * ratio(evaluation.fractureArea, evaluation.area));
  text += format("contacts per fragment  %.2f\n", evaluation.contactsPerFragment());
  if (!evaluation.convexity) {
    text += "convexity              - (no meshes here; sherd fracture --write mesh makes them)\n";
  } else if (!evaluation.standardError) {
    text += format("convexity              %.4f\n", *evaluation.convexity);
  } else {
    text += format("convexity              %.4f +- %.4f (mean and its standard error)\n",
                   *evaluation.convexity, *evaluation.standardError);
  }
  return text;
}

void runEvaluate(const EvaluateArguments& arguments) {
  const Evaluation evaluation = evaluate(arguments);
  printResult(arguments.json ? asJson(arguments, evaluation) : asText(arguments, evaluation));
}

}  // namespace

void addEvaluateCommand(CLI::App& app, Action& run) {
  CLI::App* command = app.add_subcommand("evaluate", "Measure the fragments of a fracture");
  auto arguments = std::make_shared<EvaluateArguments>();
  command->add_option("DIR", arguments->folder, "The folder of a fracture")->required();
  command
      ->add_option("--samples", arguments->samples, "Surface points per fragment for the convexity")
      ->transform(wholeNumber<std::size_t>(1, 1000000))
      ->capture_default_str();
  command->add_option("--seed", arguments->seed, "Seed of these points")
      ->transform(wholeNumber<std::uint64_t>(0, std::numeric_limits<std::uint64_t>::max()))
      ->capture_default_str();
  command->add_flag("--json", arguments->json, "Print one JSON object");
  command->callback([arguments, &run] { run = [arguments] { runEvaluate(*arguments); }; });
}

}  // namespace sherd::cli
