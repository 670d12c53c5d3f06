// Growth on every OpenCL device beside the built-in one, as one table in Markdown; run by
// tools/bench/bench_gpu.sh.
//
// usage: device_bench --list                prints a device a line: its name
//        device_bench SECONDS DEVICE...     prints the table, in at most about SECONDS
//
// Times are medians of warm runs, of the same ball and ten seeds as in grow_bench.cpp, with upload
// and read-back of the labels.  A value that takes too long, or more memory than there is, is left
// out, and so are larger ones.
#include <malloc.h>
#include <sherd/error.h>
#include <sherd/fracture.h>
#include <sherd/points.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <iostream>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ball.h"
#include "cl/device_impl.h"
#include "grown_pipeline.h"
#include "pipeline/fracture_stages.h"
#include "shapes.h"

namespace {

using Clock = std::chrono::steady_clock;
using sherd::Growth, sherd::GrowOptions;

double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// A column of the table.
struct Column {
  std::string name;
  std::unique_ptr<sherd::Device> device;
  bool isBuiltIn = false;
  std::map<std::string, int> leftOut{};  ///< the least size of a series that was left out
};

// A row: `value` returns a number in `unit`, within a time that `progress` limits.
struct Row {
  std::string series, unit;
  int size = 0;  ///< within the series, ascending
  std::function<std::optional<double>(Column&, const sherd::Progress&)> value;
  double next = 3.0;  ///< how many times as long the next size of the series takes at least
  int ball = 0;       ///< voxels of the ball that it needs, made before its time counts
};

constexpr double kMostSecondsOfAValue = 20.0;
constexpr double kMostShareOfAValue = 0.04;  // of all seconds

// The median of warm runs: a first one, then three to nine, or fewer where one takes a second.
double medianSeconds(const std::function<void()>& run) {
  run();
  std::vector<double> times;
  const Clock::time_point begin = Clock::now();
  do {
    const Clock::time_point start = Clock::now();
    run();
    times.push_back(secondsSince(start));
  } while (times.size() < 9 && (times.size() < 3 || secondsSince(begin) < 0.5) &&
           secondsSince(begin) < 2.0);
  std::nth_element(times.begin(), times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2),
                   times.end());
  return times[times.size() / 2];
}

GrowOptions growthBy(Growth growth) { return {.growth = growth, .outerSteps = 0}; }

// The seed sets of a batch: the same seeds with other ids, so that labels differ.
std::vector<std::vector<sherd::Seed>> batch(const bench::Ball& solid, int count) {
  std::vector<std::vector<sherd::Seed>> sets;
  for (int i = 0; i < count; ++i) {
    std::vector<sherd::Seed> seeds = solid.seeds;
    for (std::size_t s = 0; s < seeds.size(); ++s) {
      const std::size_t id = (s + static_cast<std::size_t>(i)) % seeds.size() + 1;
      seeds[s].fragment = static_cast<std::uint16_t>(id);
    }
    sets.push_back(std::move(seeds));
  }
  return sets;
}

double growSeconds(Column& column, int size, int fractures, const GrowOptions& options,
                   const sherd::Progress& progress) {
  const bench::Ball& solid = bench::ball(size);
  const auto sets = batch(solid, fractures);
  return medianSeconds(
      [&] { (void)sherd::grow(solid.blocks, sets, *column.device, options, &progress); });
}

Row growthRow(std::string series, int size, GrowOptions options) {
  return {series,
          "ms",
          size,
          [=](Column& c, const sherd::Progress& progress) {
            return 1e3 * growSeconds(c, size, 1, options, progress);
          },
          3.0,
          size};
}

Row batchRow(int size, int fractures) {
  const std::string series = "batches, " + std::to_string(size) + " voxels, fractures";
  return {series, "ms a fracture", fractures,
          [=](Column& c, const sherd::Progress& progress) {
            return 1e3 * growSeconds(c, size, fractures, growthBy(Growth::euclid), progress) /
                   fractures;
          },
          2.0};
}

constexpr const char* kSame = "the same";  // in place of a unit: 1 is yes

Row sameLabelsRow(std::string name, GrowOptions options) {
  return {"labels of the built-in device, " + name + ", voxels", kSame, 128,
          [=](Column& c, const sherd::Progress& progress) {
            const bench::Ball& solid = bench::ball(128);
            static sherd::Device* const builtIn = new sherd::Device("builtin");
            const auto sets = batch(solid, 2);
            const auto own = sherd::grow(solid.blocks, sets, *c.device, options, &progress);
            const auto expected = sherd::grow(solid.blocks, sets, *builtIn, options, &progress);
            bool same = true;
            for (std::size_t i = 0; i < own.size(); ++i)
              same = same && own[i].fragment == expected[i].fragment;
            return same ? 1.0 : 0.0;
          }};
}

// A flood along one row of leaves takes a launch for each voxel: microseconds a launch.
Row launchRow() {
  return {"launches, of a flood along a row of leaves", "microseconds", 1000,
          [](Column& c, const sherd::Progress& progress) {
            sherd::LeafBlocks made;
            for (int leaf = 0; leaf < 1000; ++leaf) made.origins.emplace_back(8 * leaf, 0, 0);
            made.inside.assign(8 * made.origins.size(), ~std::uint64_t{0});
            made.exteriorBand.assign(made.inside.size(), 0);
            made.neighbors = sherd::leafNeighborTable(made.origins);
            const auto blocks = std::make_shared<const sherd::LeafBlocks>(std::move(made));
            const std::vector<std::vector<sherd::Seed>> sets{{{{0, 4, 4}, 1}}};
            const double seconds = medianSeconds([&] {
              (void)sherd::grow(blocks, sets, *c.device, growthBy(Growth::flood), &progress);
            });
            return 1e6 * seconds / 8000.0;
          }};
}

enum class Way { up, down };

Row transferRow(Way way, int mebibytes) {
  return {std::string("transfers, ") + (way == Way::up ? "to" : "from") + " the device, MiB",
          "GB/s", mebibytes, [=](Column& c, const sherd::Progress&) -> std::optional<double> {
            sherd::DeviceImpl& device = implOf(*c.device);
            const std::size_t bytes = static_cast<std::size_t>(mebibytes) << 20;
            if (2 * bytes > device.info.largestBufferBytes) return std::nullopt;
            std::vector<std::uint64_t> host(bytes / 8, 1);
            const sherd::DeviceBuffer buffer = sherd::uploadBuffer<std::uint64_t>(device, host);
            const double seconds = medianSeconds([&] {
              if (way == Way::up)
                device.write(*buffer, host.data(), bytes);
              else
                device.read(*buffer, 0, bytes, host.data());
            });
            return static_cast<double>(bytes) / seconds / 1e9;
          }};
}

// Fragments a second with 1000 points on each: growth on the device, points on the host meanwhile.
double pointsPerSecond(Column& column, int size, const sherd::Progress& progress) {
  sherd::PreparedSolid ready = sherd::prepared(
      sherd::voxelize(sherd::shapes::torus(10.0, 2.0), {.resolution = size}), *column.device);
  ready.surface = sherd::intactSurface(ready.solid);
  constexpr std::size_t kFractures = 36;
  std::size_t fragments = 0;
  const auto run = [&] {
    fragments = sherd::forEachGrown(
        ready, kFractures, *column.device, &progress, [&](const sherd::GrownFracture& grown) {
          (void)sherd::samplePoints(grown.result.solid, grown.result.labels,
                                    {{.count = 1000}, nullptr, ready.surface});
        });
  };
  const double seconds = medianSeconds(run);
  return static_cast<double>(fragments) / seconds;
}

Row pointsRow(int size) {
  return {"points, 1000 on each, voxels", "fragments/s", size,
          [=](Column& c, const sherd::Progress& progress) {
            return pointsPerSecond(c, size, progress);
          }};
}

// What only OpenCL devices have.
Row tuningRow(const char* what, int value, int sherd::DeviceTuning::*field) {
  GrowOptions options = growthBy(Growth::flood);
  options.tuning.*field = value;
  return {std::string("flood, 256 voxels, ") + what, "ms", value,
          [=](Column& c, const sherd::Progress& progress) -> std::optional<double> {
            if (c.isBuiltIn) return std::nullopt;
            return 1e3 * growSeconds(c, 256, 1, options, progress);
          },
          1.0};
}

std::vector<Row> rows() {
  GrowOptions rough = growthBy(Growth::euclid), wide = growthBy(Growth::flood);
  rough.roughness = 2.0;
  wide.neighborhood = 26;
  std::vector<Row> all;
  all.push_back({"first growth, kernels built or found in a cache, voxels", "ms", 64,
                 [](Column& c, const sherd::Progress&) {  // takes as long as the driver's compiler
                   const bench::Ball& solid = bench::ball(64);
                   const Clock::time_point start = Clock::now();
                   (void)sherd::grow(solid.blocks, batch(solid, 1), *c.device,
                                     growthBy(Growth::euclid));
                   return 1e3 * secondsSince(start);
                 }});
  all.push_back(sameLabelsRow("euclid", growthBy(Growth::euclid)));
  all.push_back(sameLabelsRow("flood", growthBy(Growth::flood)));
  all.push_back(sameLabelsRow("roughness 2", rough));
  const auto addGrowth = [&](const std::vector<int>& sizes) {
    for (const int size : sizes)
      all.push_back(growthRow("flood, voxels", size, growthBy(Growth::flood)));
    for (const int size : sizes)
      all.push_back(growthRow("euclid, voxels", size, growthBy(Growth::euclid)));
  };
  addGrowth({64, 128, 256});
  for (const int fractures : {1, 4, 16, 64, 256}) all.push_back(batchRow(64, fractures));
  for (const int fractures : {1, 4, 16, 64, 256}) all.push_back(batchRow(128, fractures));
  for (const Way way : {Way::up, Way::down})
    for (const int size : {1, 64, 512}) all.push_back(transferRow(way, size));
  all.push_back(launchRow());
  for (const int size : {64, 128}) all.push_back(pointsRow(size));
  for (const int size : {128, 256}) {
    all.push_back(growthRow("flood, 26 neighbors, voxels", size, wide));
    all.push_back(growthRow("nearest, voxels", size, growthBy(Growth::nearest)));
    all.push_back(growthRow("chain, voxels", size, growthBy(Growth::chain)));
    all.push_back(growthRow("euclid, roughness 2, voxels", size, rough));
  }
  for (const int steps : {4, 16, 64})
    all.push_back(
        tuningRow("steps between readbacks", steps, &sherd::DeviceTuning::stepsPerReadback));
  for (const int items : {16, 32, 64, 128, 256})
    all.push_back(tuningRow("work-items a group", items, &sherd::DeviceTuning::workGroupSize));
  addGrowth({512, 1024});  // last, as they take longest
  return all;
}

// The cell of a row: a number, or why there is none.
//   most  seconds for it
std::string cell(const Row& row, Column& column, double most, double secondsLeft) {
  const auto skipped = column.leftOut.find(row.series);
  if (skipped != column.leftOut.end() && skipped->second < row.size) return "left out";
  const Clock::time_point begin = Clock::now();
  if (secondsLeft > 0.0 && row.ball > 0) (void)bench::ball(row.ball);
  const Clock::time_point start = Clock::now();
  secondsLeft -= std::chrono::duration<double>(start - begin).count();
  if (secondsLeft <= 0.0) return "no time left";
  const sherd::Progress progress{
      .report = {}, .cancelled = [&] { return secondsSince(start) > std::min(most, secondsLeft); }};
  try {
    const std::optional<double> value = row.value(column, progress);
    if (secondsSince(start) * row.next > most) column.leftOut[row.series] = row.size;
    if (!value) return "";
    if (row.unit == kSame) return *value == 1.0 ? "yes" : "NO";
    char text[32];
    std::snprintf(text, sizeof text, *value < 10.0 ? "%.2f" : "%.0f", *value);
    return text;
  } catch (const sherd::Error& error) {
    const bool isCancelled = error.code() == sherd::ErrorCode::cancelled;
    if (isCancelled && secondsLeft < most) return "no time left";
    column.leftOut[row.series] = row.size;
    if (isCancelled) return "too long";
    std::cerr << column.name << ", " << row.series << " " << row.size << ": " << error.what()
              << "\n";
    return "failed";
  }
}

// The chip, its driver and its memory.
std::string described(const sherd::DeviceInfo& device) {
  std::string driver;
  for (const sherd::PlatformState& platform : sherd::listPlatforms())
    for (const sherd::DeviceState& state : platform.devices)
      if (state.info.name == device.name && platform.name == device.platform) driver = state.driver;
  return device.name + " (" + device.platform +
         "): " + (driver.empty() ? "" : "driver " + driver + ", ") + device.version + ", " +
         std::to_string(device.computeUnits) + " compute units, " +
         std::to_string(device.memoryBytes >> 20) + " MiB, buffers of at most " +
         std::to_string(device.largestBufferBytes >> 20) + " MiB" +
         (device.gpu ? "" : ", not a GPU");
}

int printTable(double seconds, const std::vector<std::string>& names) {
  const Clock::time_point start = Clock::now();
  const double most = std::min(kMostSecondsOfAValue, kMostShareOfAValue * seconds);
  std::vector<Column> columns;
  for (const std::string& name : names) {
    columns.emplace_back();
    columns.back().name = name;
    columns.back().device = std::make_unique<sherd::Device>(name);
    columns.back().isBuiltIn = columns.back().device->info().platform == "builtin";
  }
  for (const Column& column : columns)
    std::cout << "- " << described(column.device->info()) << "\n";
  std::cout << "\n| measured | |";
  for (const Column& column : columns) std::cout << " " << column.device->info().name << " |";
  std::cout << "\n|---|---|";
  for (std::size_t i = 0; i < columns.size(); ++i) std::cout << "---|";
  std::cout << "\n";
  for (const Row& row : rows()) {
    std::cout << "| " << row.series << " " << row.size << " | " << row.unit << " |";
    for (Column& column : columns)
      std::cout << " " << cell(row, column, most, seconds - secondsSince(start)) << " |"
                << std::flush;
    std::cout << "\n";
  }
  // Some drivers crash when they are closed.
  for (Column& column : columns) static_cast<void>(column.device.release());
  return 0;
}

}  // namespace

int main(int count, char** arguments) {
  const std::vector<std::string> words(arguments + 1, arguments + count);
  ::mallopt(M_MMAP_MAX, 0);  // as in main.cpp
  ::mallopt(M_TRIM_THRESHOLD, -1);
  sherd::provideKernelCache();
  try {
    if (words == std::vector<std::string>{"--list"}) {
      bool any = false;
      for (const sherd::DeviceInfo& device : sherd::listDevices()) {
        if (device.platform == "builtin") continue;
        std::cout << device.name << "\n";
        any = true;
      }
      if (!any) std::cerr << "no OpenCL device can be used: " << sherd::noDeviceReason() << "\n";
      return 0;
    }
    if (words.size() >= 2)
      return printTable(std::atof(arguments[1]), {words.begin() + 1, words.end()});
  } catch (const sherd::Error& error) {
    std::cerr << "device_bench: " << error.what() << "\n";
    return static_cast<int>(error.code());
  }
  std::cerr << "usage: device_bench --list | SECONDS DEVICE...\n";
  return 2;
}
