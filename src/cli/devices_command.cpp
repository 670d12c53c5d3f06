// `sherd devices`: lists the devices of this machine.
#include <sherd/device.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "cli/terminal/command.h"

namespace sherd::cli {
namespace {

std::string asJson(const std::vector<DeviceInfo>& devices) {
  nlohmann::ordered_json json = {
      {"schema", "sherd-report/1"}, {"command", "devices"}, {"devices", nlohmann::json::array()}};
  for (const DeviceInfo& device : devices) {
    nlohmann::ordered_json caveat;  // null where there is none
    if (!device.caveat.empty()) caveat = device.caveat;
    json["devices"].push_back({{"platform", device.platform},
                               {"name", device.name},
                               {"version", device.version},
                               {"gpu", device.gpu},
                               {"compute_units", device.computeUnits},
                               {"memory_bytes", device.memoryBytes},
                               {"largest_buffer_bytes", device.largestBufferBytes},
                               {"caveat", caveat},
                               {"chosen", device.chosen}});
  }
  return json.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

std::string deviceList(const std::vector<DeviceInfo>& devices) {
  if (devices.empty()) {
    return "no device can be used: " + noDeviceReason() + " (sherd doctor reports more)\n";
  }
  std::string text;
  for (const DeviceInfo& device : devices) {
    text += std::string(device.chosen ? "* " : "  ") + (device.gpu ? "gpu  " : "cpu  ") +
            device.platform + " / " + device.name + ": " + std::to_string(device.computeUnits) +
            " compute units, " + std::to_string(device.memoryBytes >> 20) + " MiB, " +
            device.version + (device.caveat.empty() ? "" : "; " + device.caveat) + "\n";
  }
  return text + "* is what --device auto picks\n";
}

}  // namespace

void addDevicesCommand(CLI::App& app, Action& run) {
  CLI::App* command = app.add_subcommand("devices", "List the devices, and which one auto picks");
  auto json = std::make_shared<bool>(false);
  command->add_flag("--json", *json, "Print one JSON object");
  command->callback([json, &run] {
    run = [json] {
      provideKernelCache();
      const std::vector<DeviceInfo> devices = listDevices();
      printResult(*json ? asJson(devices) : deviceList(devices));
    };
  });
}

}  // namespace sherd::cli
