#pragma once

#include "appliance/appliance.hpp"
#include "doctor/doctor.hpp"
#include "http/page.hpp"
#include "scan/scanner.hpp"

namespace octurn {

/// What requests are answered from: the scanner, what it has stored, and the page that shows it.
struct App {
  Scanner& scanner;
  const ScanStore& store;
  const Page& page;
  DoctorInput doctor_input;        ///< this scanner, with the configuration in force
  Appliance* appliance = nullptr;  ///< that this machine is; null: none
};

}  // namespace octurn
