#include "scan/rebuild.hpp"

#include <span>
#include <utility>

#include "failure.hpp"
#include "log.hpp"
#include "octurn/mesh_report.hpp"
#include "octurn/scan_folder.hpp"
#include "octurn/stl.hpp"
#include "scan/stored_scan.hpp"

namespace octurn {
namespace {

void stream_model(const RebuildCommand& command) {
  ModelPipe& pipe = *command.pipe;
  const std::stop_token stop = pipe.stop().get_token();
  const Scan scan = read_scan(command.folder);
  const SnapshotSource snapshots = readable_snapshots(command.folder, scan, stop);
  ReconstructOptions options = command.options;
  options.clip = model_clip(scan);
  options.placements = placements(scan);
  fit_to_sensor(options, scan);
  const std::unique_ptr<Reconstructor> reconstruction = make_reconstructor(options);
  reconstruction->add(snapshots, stop);
  const SurfaceCount count = reconstruction->count(snapshots, stop);
  expect_facets(count);
  pipe.set_length(stl_bytes(count.facets));
  pipe.write(stl_header(count.facets));
  const auto send = [&](std::span<const Facet> facets) { pipe.write(std::as_bytes(facets)); };
  if (!write_model(*reconstruction, snapshots, send, stop)) {
    throw Stopped{};
  }
  pipe.close();
}

}  // namespace

void rebuild(const RebuildCommand& command) {
  try {
    stream_model(command);
  } catch (const Stopped&) {
    command.pipe->stop().request_stop();
  } catch (...) {
    Failure failure = current_failure();
    log::error("scanner", "model from " + command.folder.string() + ": " + failure.detail);
    command.pipe->fail(std::move(failure));
  }
}

}  // namespace octurn
