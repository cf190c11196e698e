#include "http/handlers/bin.hpp"

#include <nlohmann/json.hpp>

#include "http/json_body.hpp"
#include "http/scan_view.hpp"
#include "utc.hpp"

namespace octurn {
namespace {

using nlohmann::json;

std::string to_text(ScanTime time) {
  return utc_text(std::chrono::floor<std::chrono::seconds>(time), rfc3339);
}

/// Whether a scan in another pose is in the bin together with its first scan.
bool is_with_another(const ScanBin& bin, const Job& job) {
  return job.pose_of && bin.find(job.pose_of->scan);
}

}  // namespace

Response send_bin(App& app) {
  json scans = json::array();
  for (const BinnedScan& scan : app.store.bin().list()) {
    const Job& job = scan.job;
    if (!is_with_another(app.store.bin(), job)) {
      scans.push_back({{"id", job.id},
                       {"name", job.label.name},
                       {"created", job.times.created},
                       {"state", to_string(job.state)},
                       {"snapshots_done", job.snapshots_done},
                       {"deleted", to_text(scan.deleted)},
                       {"kept_until", to_text(scan.deleted + days_in_bin)}});
    }
  }
  return json_response({{"scans", scans}});
}

Response empty_bin(App& app) {
  app.scanner.empty_bin();
  return {.status = 204};
}

Response restore_scan(App& app, std::string_view id) {
  app.scanner.restore(id);
  return json_response(to_json(app, find_scan(app, id)));
}

}  // namespace octurn
