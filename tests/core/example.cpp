#include <iostream>

#include "octurn/error.hpp"
#include "octurn/model.hpp"
#include "octurn/scan_folder.hpp"

// example SCAN_FOLDER OUTPUT.stl
int main(int /*count*/, char** arguments) try {
  const octurn::Scan scan = octurn::read_scan(arguments[1]);
  const auto snapshots = octurn::stored_snapshots(arguments[1], scan);
  const auto reconstructor = octurn::make_reconstructor(octurn::model_options(scan));
  reconstructor->add(snapshots);
  octurn::write_model(*reconstructor, snapshots, arguments[2], {});
} catch (const octurn::Error& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
