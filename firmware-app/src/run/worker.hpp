#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>

#include "calibration/calibration_store.hpp"
#include "calibration/lens_files.hpp"
#include "calibration/optics_files.hpp"
#include "capture/capture.hpp"
#include "latest.hpp"
#include "run/command_slot.hpp"
#include "run/run_scan.hpp"
#include "run/status_board.hpp"
#include "store/scan_store.hpp"

namespace octurn {

/// References to the parts of a Scanner that the worker shares.
struct WorkerPorts {
  ScanStore& store;
  StatusBoard& board;  ///< only written to
  Latest<DeviceStates>& devices;
  CommandSlot& slot;
  Heartbeat& heartbeat;
  CalibrationStore& calibration;
  std::mutex& scans;  ///< serialises changes of scans' states, with the Scanner
  std::optional<SolvedLens>& solved_lens;  ///< guarded by `scans`
};

struct MergedTurns;

/// Executes the commands of a slot, one after the other, on the thread that calls `work`. Owns
/// sensor, turntable and the running scan; other threads see only what it publishes.
class Worker {
 public:
  Worker(const RigOptions& rig, const Limits& limits, const WorkerPorts& ports);

  /// Returns when the slot has ended.
  void work();

 private:
  using Clock = std::chrono::steady_clock;

  void carry_out(CommandSlot::Taken& taken);
  void carry_out(CameraCommand& command, const std::stop_source& stop);
  void carry_out(DeviceCheckCommand& command, const std::stop_source& stop);
  void carry_out(RebuildCommand& command, const std::stop_source& stop);
  void carry_out(BuildCommand& command, const std::stop_source& stop);
  void carry_out(ScanCommand& command, const std::stop_source& stop);
  void carry_out(ResumeCommand& command, const std::stop_source& stop);
  void carry_out(CalibrateCommand& command, const std::stop_source& stop);
  void carry_out(WallCommand& command, const std::stop_source& stop);
  void carry_out(LensCommand& command, const std::stop_source& stop);

  void open_turntable();
  void run(Job job, const std::stop_token& stop);
  void run_until_it_ends(const std::stop_token& stop);
  void attempt(const std::stop_token& stop);
  void expect_same_sensor();
  bool join(const std::stop_token& stop);
  void show_join(Phase phase);
  bool keep_merged(const Job& first, const MergedTurns& merged, const std::stop_token& stop);
  ScanObserver observer(const std::stop_token& stop);
  void show_next_frame(const std::stop_token& stop);
  void set_sensor_ready(const std::string& name);
  void set_sensor_failed(const Failure& failure);
  void set_turntable_ready();
  void set_turntable_failed(const Failure& failure);
  void show(DepthFrame frame);
  void show(Picture picture);
  void show_progress(Phase phase, int snapshots_done);
  void begin(Phase phase);
  void show_job();
  void save_progress();
  void keep_calibration(const ScanSolution& solution);
  void keep_pose(PoseRecord pose, const CalibrationReport& report, OpticsOrigin origin);
  void show_rebuilt(int snapshots);
  void measure(CalibrationRun& run, const ScanSettings& settings, const std::stop_token& stop);
  void measure_wall(CalibrationRun& run, const std::stop_token& stop);
  void find_lens(CalibrationRun& run, double square, const std::stop_token& stop);
  void report_look(CalibrationRun& run, const BoardLook& look);
  bool is_board_put_away(CalibrationRun& run, const std::stop_token& stop) const;
  std::filesystem::path first_scan() const;
  void carry_out(CalibrationRun run, const std::function<void(CalibrationRun& run)>& measurement);
  void introduce_sensor();
  void close_device(const Failure& failure);
  void release_rig();
  void save_platform_angle(double angle_deg);
  void finish();

  Rig rig_;
  double speed_;  // of a simulated rig, relative to real time
  Retries retries_;
  std::optional<std::chrono::seconds> sensor_off_after_;
  Limits limits_;
  WorkerPorts ports_;
  std::unique_ptr<Capture> capture_;  // of `rig_`
  Job job_ = {};                      // the scan that runs
  Clock::time_point job_started_ = {};
  std::optional<TimeLeft> time_left_ = {};            // of the running scan
  std::optional<Clock::time_point> gives_up_ = {};    // when retries of a failing stop end
  Clock::time_point rebuild_started_ = {};            // when its model was begun again
  std::optional<Clock::time_point> introduced_ = {};  // opening time of the published sensor
};

}  // namespace octurn
