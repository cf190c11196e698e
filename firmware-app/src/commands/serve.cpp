#include <iostream>

#include "appliance/appliance.hpp"
#include "commands/commands.hpp"
#include "http/api.hpp"
#include "http/http_server.hpp"
#include "log.hpp"
#include "process_memory.hpp"
#include "scan/scanner.hpp"
#include "sensor/depth_sensor.hpp"
#include "service_manager.hpp"
#include "signal_stop.hpp"
#include "version.hpp"

namespace octurn {
namespace {

/// URL of the page for a browser on this machine.
std::string page_address(const HttpOptions& options, int port) {
  const bool any = options.address == "0.0.0.0" || options.address == "::";
  const bool v6 = options.address.find(':') != std::string::npos;
  const std::string host = any ? "localhost" : v6 ? "[" + options.address + "]" : options.address;
  return "http://" + host + ":" + std::to_string(port) + "/";
}

/// Waits for SIGINT or SIGTERM. Meanwhile it notifies systemd's watchdog as long as the scanner's
/// worker is alive.
void wait(const Scanner& scanner) {
  const auto interval = watchdog_interval();
  if (!interval) {
    wait_for_signal();
    return;
  }
  while (!wait_for_signal(*interval / 3)) {
    if (scanner.is_alive()) {
      notify_alive();
    } else {
      log::error("octurn", "the scanner's worker has stopped working");
    }
  }
}

}  // namespace

void serve(const ServeArguments& arguments) {
  return_freed_memory();
  const Config config = make_config(arguments.config);
  const RigOptions rig = rig_options(arguments.rig, config.turntable);
  load_sensor_drivers();  // before the first thread, as it asks

  const Page page(arguments.web ? *arguments.web : page_folder());
  ScanStore store(config.data);
  Scanner scanner(rig, config.limits, store);
  std::optional<Appliance> appliance;
  if (arguments.appliance) {
    appliance.emplace(*arguments.appliance);
  }
  Api api({.scanner = scanner,
           .store = store,
           .page = page,
           .doctor_input = {.rig = rig, .config = config},
           .appliance = appliance ? &*appliance : nullptr});
  const HttpServer server(config.http, [&](const Request& request) { return api.answer(request); });

  std::cout << "Octurn is at " << page_address(config.http, server.port()) << std::endl;
  log::info("octurn", "version " + std::string(version()) + " ready");
  notify_ready("serving the page at port " + std::to_string(server.port()));
  wait(scanner);
  log::info("octurn", "ending");
  notify_stopping();
  scanner.request_stop();  // so that no request waits for it while the server ends
}

}  // namespace octurn
