// Figures out of journals and records.
#include "dataset/figures.h"

#include <algorithm>
#include <fstream>
#include <numeric>
#include <set>

#include "dataset/fracture_line.h"

namespace sherd {
namespace {

namespace fs = std::filesystem;

// In all layouts points lie in a folder of that name, or end in their number: M_4f_0_1024p.binp.
bool isOfPoints(const fs::path& name) {
  for (const fs::path& part : name.parent_path()) {
    if (part == "points") return true;
  }
  const std::string stem = name.stem().string();
  const std::size_t digits = stem.find_last_of('_');
  return digits != std::string::npos && digits + 2 < stem.size() && stem.back() == 'p' &&
         stem.find_first_not_of("0123456789", digits + 1) == stem.size() - 1;
}

// What a fragment's file is counted with, or null.
FileFigures* kindOf(DatasetFigures& figures, const std::string& name) {
  static const std::set<std::string> kMeshes{".ply", ".obj", ".stl", ".glb", ".binm"};
  const fs::path path(name);
  const bool isPacked = path.extension() == ".zip" || path.extension() == ".zst";
  const fs::path plain = isPacked ? fs::path(path).replace_extension() : path;
  if (plain.extension() == ".vdb") return &figures.voxels;
  if (isOfPoints(plain)) return &figures.points;
  return kMeshes.contains(plain.extension().string()) ? &figures.meshes : nullptr;
}

void addFracture(DatasetFigures& figures, const Json& line) {
  std::map<std::string, std::uint64_t> bytes;
  for (const FileRecord& file : filesOf(line)) {
    bytes[file.name] = file.bytes;
    figures.byFormat[formatOf(file.name)].add({1, file.bytes});
  }
  for (const Json& name : line.at("labels")) figures.voxels.add({1, bytes[name]});
  const bool isWhole = line.at("fracture") == kWholeName;
  PieceFigures* const pieces = isWhole ? nullptr : &figures.byPieces[line.at("pieces")];
  if (pieces) {
    ++pieces->fractures;
    ++figures.fractures;
  }
  for (const Json& fragment : line.at("fragments")) {
    if (fragment.value("withheld", false)) continue;
    for (const Json& name : fragment.at("files")) {
      if (FileFigures* const kind = kindOf(figures, name)) kind->add({1, bytes[name]});
    }
    if (!pieces) continue;
    ++figures.fragments;
    pieces->faces.push_back(fragment.at("faces"));
    pieces->vertices.push_back(fragment.at("vertices"));
    pieces->share.push_back(fragment.at("share"));
  }
}

RunFigures runOf(const Json& json, const std::string& name) {
  RunFigures run;
  run.name = name;
  run.seconds = json.at("seconds");
  run.device = json.at("device").at("name");
  for (const auto& [stage, seconds] : json.at("stages").items()) run.stages[stage] = seconds;
  const Json& samples = json.at("samples");
  run.at = samples.at("seconds").get<std::vector<double>>();
  run.cores = samples.at("cores").get<std::vector<double>>();
  run.memory = samples.at("memory").get<std::vector<double>>();
  run.deviceMemory = samples.at("device_memory").get<std::vector<double>>();
  return run;
}

// Of run.json, and of run_2_of_4.json and the like.  A record that is damaged is left out: no more
// than the report hangs on it.
std::vector<RunFigures> runsOf(const fs::path& out) {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(out)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("run") && entry.path().extension() == ".json") files.push_back(entry);
  }
  std::sort(files.begin(), files.end());
  std::vector<RunFigures> runs;
  for (const fs::path& file : files) {
    std::string name = file.stem().string();
    std::replace(name.begin(), name.end(), '_', ' ');
    std::ifstream in(file);
    const Json json = Json::parse(in, nullptr, false);
    if (!json.is_object()) continue;
    for (const Json& run : json.value("runs", Json::array())) {
      try {
        runs.push_back(runOf(run, name));
      } catch (const Json::exception&) {
        continue;
      }
    }
  }
  return runs;
}

}  // namespace

double DatasetFigures::seconds() const {
  return std::accumulate(runs.begin(), runs.end(), 0.0,
                         [](double sum, const RunFigures& run) { return sum + run.seconds; });
}

DatasetFigures figuresOf(const fs::path& out, const DatasetPlan& plan) {
  DatasetFigures figures;
  for (const LibraryObject& object : plan.objects) {
    const JournalText journal = readJournal(journalOf(out, object));
    if (journal.failed) figures.failures.emplace_back(object.key, *journal.failed);
    if (!journal.done) continue;
    ++figures.objects;
    for (const Json& line : journal.fractures) addFracture(figures, line);
  }
  figures.runs = runsOf(out);
  return figures;
}

}  // namespace sherd
