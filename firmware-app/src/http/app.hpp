#pragma once

#include <memory>

#include "appliance/appliance.hpp"
#include "config/config_store.hpp"
#include "doctor/doctor.hpp"
#include "doctor/machine_checks.hpp"
#include "doctor/turntable_runner.hpp"
#include "http/access_keys.hpp"
#include "http/page.hpp"
#include "outgoing/address_book.hpp"
#include "outgoing/printer_uploads.hpp"
#include "outgoing/webhook_sender.hpp"
#include "run/scanner.hpp"

namespace octurn {

/// The objects that requests are answered from: the scanner, its stored scans, and the page.
struct App {
  Scanner& scanner;
  const ScanStore& store;
  const Page& page;
  ConfigStore& settings;
  TurntableRunner& turntable;
  AccessKeys& keys;
  const MachineWatch& machine;
  AddressBook& addresses;
  PrinterUploads& uploads;
  RigOptions rig;                  ///< of the scanner
  Appliance* appliance = nullptr;  ///< null: this machine does not run Octurn's image
  /// Started by Api, as it reads all members above. The last member, so that it ends first.
  std::unique_ptr<WebhookSender> webhooks = {};

  DoctorInput doctor_input() const {
    return octurn::doctor_input(rig, settings, scanner.calibration(), store);
  }
};

}  // namespace octurn
