#include "http/scan_json.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <utility>

#include "store/job_json.hpp"

namespace octurn {
namespace {

using nlohmann::json;

std::string path_to(const std::string& id) { return "/api/v1/scans/" + id; }

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream all(text);
  for (std::string line; std::getline(all, line);) {
    lines.push_back(line);
  }
  return lines;
}

json with_url(const Model& model, std::string url) {
  json object = to_json(model);
  object["url"] = std::move(url);
  return object;
}

json to_json(const std::optional<ScanCalibration>& calibration) {
  return calibration ? to_json(*calibration) : json();
}

json to_json(const std::optional<std::chrono::duration<double>>& time) {
  return time ? json(to_thousandths(time->count())) : json();
}

json to_json(const ClusterJob& job) { return {{"id", job.id}, {"detail", job.detail}}; }

}  // namespace

json to_json(const Job& job) {
  const Model* const model = chosen_model(job);
  json object = {
      {"id", job.id},
      {"state", to_string(job.state)},
      {"phase", to_string(job.phase)},
      {"created", job.times.created},
      {"snapshots_done", job.snapshots_done},
      {"snapshots_total", job.settings.snapshots},
      {"seconds_elapsed", to_thousandths(job.times.elapsed.count())},
      {"seconds_left", to_json(job.times.left)},
      {"seconds_until_pause", to_json(job.times.until_pause)},
      {"late_pulses", job.times.late_pulses},
      {"slips", job.times.slips},
      {"seconds_settling", to_thousandths(job.times.settling.count())},
      {"settings", to_json(job.settings)},
      {"error", job.failure ? to_json(*job.failure) : json()},
      {"calibration", to_json(job.calibration)},
      {"model", model != nullptr ? with_url(*model, path_to(job.id) + "/Scan.stl") : json()},
      {"build", find_build(job, job.builds.chosen) != nullptr ? job.builds.chosen : 0},
      {"pose_of", job.pose_of ? to_json(*job.pose_of) : json()},
      {"has_colours", job.builds.have_colours},
      {"has_views", job.builds.have_views}};
  for (const LabelText& text : label_texts()) {
    const std::string& written = job.label.*text.text;
    object[std::string(text.key)] = text.is_list ? json(lines_of(written)) : json(written);
  }
  return object;
}

json to_json(const Job& job, const Build& build) {
  const std::string number = std::to_string(build.number);
  const bool is_chosen = find_build(job, job.builds.chosen) != nullptr
                             ? job.builds.chosen == build.number
                             : build.number == 0;
  return {{"scan", job.id},
          {"build", build.number},
          {"state", to_string(BuildRun::State::finished)},
          {"phase", to_string(Phase::done)},
          {"created", build.created},
          {"snapshots_done", job.snapshots_done},
          {"snapshots_total", job.snapshots_done},
          {"settings", to_json(build.settings)},
          {"error", nullptr},
          {"calibration", to_json(build.calibration)},
          {"model", with_url(build.model, path_to(job.id) + "/builds/" + number + "/Scan.stl")},
          {"chosen", is_chosen},
          {"poses", build.poses},
          {"cluster_job", nullptr}};
}

json to_json(const BuildRun& run) {
  return {{"scan", run.scan},
          {"build", run.number},
          {"state", to_string(run.state)},
          {"phase", to_string(run.phase)},
          {"created", run.created},
          {"snapshots_done", run.snapshots_done},
          {"snapshots_total", run.snapshots},
          {"settings", to_json(run.settings)},
          {"error", run.failure ? to_json(*run.failure) : json()},
          {"calibration", nullptr},
          {"model", nullptr},
          {"chosen", false},
          {"poses", json::array()},
          {"cluster_job", run.cluster_job ? to_json(*run.cluster_job) : json()}};
}

json poses_json(const std::vector<Job>& poses) {
  json list = json::array();
  for (const Job& pose : poses) {
    list.push_back(pose_json(pose, static_cast<int>(list.size()) + 1));
  }
  return list;
}

json pose_json(const Job& job, int number) {
  json pose = to_json(*job.pose_of);
  pose["pose"] = number;
  pose["scan"] = job.id;
  pose["state"] = to_string(job.state);
  pose["model"] = job.model ? json(path_to(job.id) + "/builds/0/Scan.stl") : json();
  return pose;
}

json builds_json(const Job& job, const std::vector<BuildRun>& runs) {
  json builds = json::array();
  if (job.model) {
    builds.push_back(to_json(job, {.number = 0,
                                   .created = job.times.created,
                                   .settings = {.scan = job.settings},
                                   .calibration = job.calibration,
                                   .model = *job.model}));
  }
  for (const Build& build : job.builds.all) {
    const bool goes_on = std::ranges::any_of(runs, [&](const BuildRun& run) {
      return run.scan == job.id && run.number == build.number && !run.has_ended();
    });
    if (!goes_on) {  // otherwise its run is listed below
      builds.push_back(to_json(job, build));
    }
  }
  for (const BuildRun& run : runs) {
    if (run.scan == job.id && run.state != BuildRun::State::finished) {
      builds.push_back(to_json(run));
    }
  }
  return builds;
}

}  // namespace octurn
