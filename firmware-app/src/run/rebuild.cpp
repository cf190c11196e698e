#include "run/rebuild.hpp"

#include <span>
#include <utility>

#include "failure.hpp"
#include "log.hpp"
#include "octurn/model.hpp"
#include "octurn/scan_folder.hpp"
#include "octurn/stl.hpp"
#include "store/stored_scan.hpp"

namespace octurn {

void make_model(const std::filesystem::path& folder, ReconstructOptions options, ModelPipe& pipe) {
  const std::stop_token stop = pipe.stop().get_token();
  const Scan scan = read_scan(folder);
  const SnapshotSource snapshots = readable_snapshots(folder, scan, stop);
  options.clip = model_clip(scan);
  options.placements = placements(scan);
  fit_to_sensor(options, scan);
  const std::unique_ptr<Reconstructor> reconstruction = make_reconstructor(options);
  reconstruction->add(snapshots, stop);
  const SurfaceCount count = reconstruction->count(snapshots, stop);
  expect_facets(count.facets);
  pipe.set_length(stl_bytes(count.facets));
  pipe.write(stl_header(count.facets));
  const auto send = [&](std::span<const Facet> facets) { pipe.write(std::as_bytes(facets)); };
  reconstruction->surface(snapshots, send, stop);
  pipe.close();
}

void rebuild(const RebuildCommand& command) {
  try {
    command.make(*command.pipe);
  } catch (const Stopped&) {
    command.pipe->stop().request_stop();
  } catch (...) {
    Failure failure = current_failure();
    log::error("scanner", "cannot make the model that a request asked for: " + failure.detail);
    command.pipe->fail(std::move(failure));
  }
}

}  // namespace octurn
