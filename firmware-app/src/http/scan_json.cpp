#include "http/scan_json.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "octurn/units.hpp"
#include "scan/calibration_json.hpp"
#include "scan/failure_json.hpp"
#include "scan/quality_json.hpp"

namespace octurn {
namespace {

using nlohmann::json;

/// Thousandths, as people and the page read them.
double rounded(double value) { return std::round(value * 1000) / 1000; }

json to_json(const Model& model, const std::string& id) {
  const ModelReport& report = model.report;
  const bool counted = report.parts > 0;
  json size_mm = json::array();
  for (const double side : report.size) {
    size_mm.push_back(rounded(mm_from_metres(side)));
  }
  return {{"url", "/api/v1/scans/" + id + "/Scan.stl"},
          {"bytes", report.bytes},
          {"triangles", report.triangles},
          {"leaves", report.leaves},
          {"parts", counted ? json(report.parts) : json()},
          {"filled_share", counted ? json(rounded(report.filled_share)) : json()},
          {"watertight", report.watertight},
          {"volume_cm3", rounded(cm3_from_m3(report.volume))},
          {"size_mm", size_mm},
          {"seconds", rounded(model.build_time.count())},
          {"quality", model.quality ? to_json(*model.quality) : json()}};
}

}  // namespace

json to_json(const Job& job) {
  return {{"id", job.id},
          {"name", job.name},
          {"state", to_string(job.state)},
          {"phase", to_string(job.phase)},
          {"created", job.created},
          {"snapshots_done", job.snapshots_done},
          {"snapshots_total", job.settings.snapshots},
          {"seconds_elapsed", rounded(job.times.elapsed.count())},
          {"seconds_left", job.times.left ? json(rounded(job.times.left->count())) : json()},
          {"late_pulses", job.late_pulses},
          {"settings", to_json(job.settings)},
          {"error", job.failure ? to_json(*job.failure) : json()},
          {"calibration", job.calibration ? to_json(*job.calibration) : json()},
          {"model", job.model ? to_json(*job.model, job.id) : json()}};
}

}  // namespace octurn
