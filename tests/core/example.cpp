#include "octurn/model.hpp"
#include "octurn/scan_folder.hpp"

// example SCAN_FOLDER OUTPUT.stl
int main(int /*count*/, char** arguments) {
  const octurn::Scan scan = octurn::read_scan(arguments[1]);
  const auto snapshots = octurn::stored_snapshots(arguments[1], scan);
  const auto reconstructor = octurn::make_reconstructor({
      .method = octurn::Method::solid,
      .leaf_size = 0.001,  // metres
      .clip = scan.clip,
  });
  reconstructor->add(snapshots);
  octurn::write_model(*reconstructor, snapshots, arguments[2], {});
}
