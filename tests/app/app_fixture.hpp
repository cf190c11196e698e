#pragma once

#include <atomic>

#include "app/scanner_fixture.hpp"
#include "http/app.hpp"

namespace octurn {

/// The daemon's state with a simulated rig.
class AppTest : public ScannerTest {
 protected:
  App make_app() {
    return {.scanner = scanner_,
            .store = store_,
            .page = page_,
            .settings = settings_,
            .turntable = turntable_,
            .keys = keys_,
            .machine = machine_,
            .addresses = addresses_,
            .uploads = uploads_,
            .rig = rig()};
  }

  Scanner scanner_{rig(), {}, store_};
  Page page_{make_page()};
  ConfigStore settings_{ConfigLayers{.file = {.data = folder_.path()}}};
  TurntableRunner turntable_{scanner_, store_};
  AccessKeys keys_{folder_.path() / "keys.json"};
  AddressBook addresses_{folder_.path() / "addresses.json"};
  PrinterUploads uploads_;
  std::atomic<std::uint64_t> free_ = 5;
  MachineWatch machine_{{.free_bytes = [this] { return free_.load(); },
                         .warnings = [] { return std::vector<Finding>{}; }},
                        {.disk = std::chrono::milliseconds(1)}};

 private:
  std::filesystem::path make_page() const {
    put(folder_.path() / "index.html", "<!doctype html>");
    return folder_.path();
  }
};

}  // namespace octurn
