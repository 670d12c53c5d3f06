// `sherd doctor`: prints what a bug report begins with.
#include <sherd/error.h>

#include <cstdio>
#include <memory>
#include <string_view>

#include "base/text/formatted.h"
#include "cli/doctor/doctor.h"
#include "cli/terminal/command.h"

namespace sherd::cli {
namespace {

using Json = nlohmann::ordered_json;

// ---- Plain text: sections of lines

std::string pad(const std::string& text, std::size_t width) {
  return text + std::string(text.size() < width ? width - text.size() : 1, ' ');
}

std::string plain(const std::string& key, const Json& value) {
  if (value.is_null()) return "none";
  if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
  if (key.ends_with("_bytes")) return formatted("%.3g GB", value.get<double>() / 1e9);
  if (key.ends_with("_seconds")) return formatted("%.3f s", value.get<double>());
  if (value.is_string()) return value.get<std::string>();
  if (!value.is_array()) return value.dump();
  std::string text;
  for (const Json& item : value) text += (text.empty() ? "" : "; ") + plain({}, item);
  return text.empty() ? "none" : text;
}

// Returns "left by ulimit" for "left_by_ulimit_bytes".
std::string label(std::string key) {
  for (const std::string_view unit : {"_bytes", "_seconds"}) {
    if (key.ends_with(unit)) key = key.substr(0, key.size() - unit.size());
  }
  for (char& c : key) {
    if (c == '_') c = ' ';
  }
  return key;
}

// Returns a text, or "none".
std::string textOf(const Json& value) { return plain({}, value); }

std::string platformText(const Json& platform) {
  const std::string name = textOf(platform["name"]);
  if (platform["devices"].empty()) return "  " + name + ": " + textOf(platform["fault"]) + "\n";
  std::string text;
  for (const Json& device : platform["devices"]) {
    text += "  " + name + " / " + textOf(device["name"]) + ": " +
            (device["gpu"].get<bool>() ? "GPU" : "no GPU") + ", " + textOf(device["version"]) +
            (device["driver"].is_null() ? "" : ", driver " + textOf(device["driver"])) + ", " +
            textOf(device["compute_units"]) + " compute units, " +
            plain("memory_bytes", device["memory_bytes"]);
    if (!device["fault"].is_null()) text += "; cannot be used: " + textOf(device["fault"]);
    if (!device["caveat"].is_null()) text += "; " + textOf(device["caveat"]);
    if (device["chosen"].get<bool>()) text += "; what --device auto picks";
    text += "\n";
  }
  return text;
}

std::string driverText(const Json& driver) {
  const bool loads = driver["fault"].is_null();
  return "  " + textOf(driver["file"]) + ": " +
         (loads ? textOf(driver["library"]) + ", loads" : textOf(driver["fault"])) + "\n";
}

std::string sectionText(const std::string& name, const Json& section, const Json& all) {
  std::string text;
  if (name == "drivers") {
    for (const Json& driver : section) text += driverText(driver);
    return "OpenCL drivers in " + textOf(all["driver_folder"]) + "\n" +
           (text.empty() ? "  none\n" : text);
  }
  if (name == "platforms") {
    for (const Json& platform : section) text += platformText(platform);
    return "devices\n" + (text.empty() ? "  none\n" : text);
  }
  if (name == "drivers_print" && section.is_string())
    return "what drivers print\n  " + textOf(section) + "\n";
  if (!section.is_object()) return {};  // printed with the drivers
  for (const auto& [key, value] : section.items())
    text += "  " + pad(name == "environment" ? key : label(key), 22) + plain(key, value) + "\n";
  return label(name) + "\n" + text;
}

void runDoctor(const std::string& device, bool json) {
  Diagnosis diagnosis;
  const Json environment = environmentFacts();
  const std::vector<KernelCache> caches = provideKernelCache();
  DeviceExamination examination(device);
  addHostFacts(diagnosis, caches);
  examination.addTo(diagnosis);
  diagnosis.sections["environment"] = environment;
  printResult(json ? asJson(diagnosis) : asText(diagnosis));
  if (!diagnosis.deviceWorks)
    throw Error(ErrorCode::device, "no device works; see what is wrong above");
}

}  // namespace

std::string asText(const Diagnosis& diagnosis) {
  std::string text;
  for (const auto& [name, section] : diagnosis.sections.items())
    text += sectionText(name, section, diagnosis.sections);
  if (diagnosis.problems.empty()) return text + "All is well.\n";
  text += "What is wrong\n";
  for (const std::string& problem : diagnosis.problems) text += "  - " + problem + ".\n";
  return text;
}

std::string asJson(const Diagnosis& diagnosis) {
  Json json = {{"schema", "sherd-report/1"}, {"command", "doctor"}};
  json.update(diagnosis.sections);
  json["device_works"] = diagnosis.deviceWorks;
  json["problems"] = diagnosis.problems;
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

void addDoctorCommand(CLI::App& app, Action& run) {
  CLI::App* command = app.add_subcommand(
      "doctor", "Report versions, devices, folders and memory, and what is wrong with them");
  auto device = std::make_shared<std::string>("auto");
  auto json = std::make_shared<bool>(false);
  command
      ->add_option("--device", *device,
                   "The device to try: auto, gpu, cpu, builtin or a part of its name")
      ->capture_default_str();
  command->add_flag("--json", *json, "Print one JSON object");
  command->callback([device, json, &run] { run = [device, json] { runDoctor(*device, *json); }; });
}

}  // namespace sherd::cli
