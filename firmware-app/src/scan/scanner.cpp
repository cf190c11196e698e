#include "scan/scanner.hpp"

#include <algorithm>
#include <utility>

#include "log.hpp"
#include "octurn/stl_file.hpp"
#include "scan/run_scan.hpp"

namespace octurn {
namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

constexpr auto view_patience =
    15s;  // a sensor takes 1 to 2 s to its first frame, on a busy machine more
constexpr auto view_interest = 5s;      // frames are read for that long after someone asked
constexpr auto fresh = 200ms;           // a view of that age shows what is there now
constexpr auto retry_interval = 2s;     // between attempts to open a sensor that did not work
constexpr auto open_without_use = 30s;  // then the sensor is closed: its light and traffic end

// A preview is sent after every snapshot: at most 3 MB, and of leaves as fine as a screen shows.
constexpr double preview_leaf_size = 0.004;  // metres
constexpr std::uint64_t most_preview_facets = 60'000;

DeviceStatus::State state_for(const std::string& code) {
  return code.ends_with("-missing") ? DeviceStatus::State::missing : DeviceStatus::State::failed;
}

}  // namespace

Scanner::Scanner(RigOptions rig, const Limits& limits, const ScanStore& store)
    : rig_options_(std::move(rig)), limits_(limits), store_(store) {
  status_.update([&](Status& status) {
    status.sensor.simulated = is_simulated_sensor(rig_options_.sensor_uri);
    status.sensor.message = "looking for the sensor";
    status.turntable.simulated = !rig_options_.stepper;
    status.turntable.name = status.turntable.simulated ? "simulated turntable" : "stepper";
    status.turntable.message = "looking for the turntable";
  });
  worker_ = std::jthread([this](const std::stop_token& stop) { work(stop); });
}

std::optional<Job> Scanner::start(const ScanSettings& settings) {
  const std::lock_guard lock(mutex_);
  if (order_) {
    return std::nullopt;
  }
  const Job job = store_.create(settings);
  order_ = Order{.job = job};
  status_.update([&](Status& status) {
    status.job = job;
    status.job_started = Clock::now();
    status.job_end.reset();
  });
  preview_.set({.id = job.id});
  if (leave_) {
    leave_->request_stop();
  }
  if (loan_ != nullptr) {
    loan_->stop.request_stop();
  }
  wake_.notify_all();
  return job;
}

bool Scanner::cancel(std::string_view id) {
  const std::lock_guard lock(mutex_);
  if (!order_ || order_->job.id != id) {
    return false;
  }
  order_->cancel.request_stop();
  return true;
}

std::unique_ptr<Scanner::Leave> Scanner::leave_to_reconstruct() {
  const std::lock_guard lock(mutex_);
  if (order_ || leave_ || worker_.get_stop_token().stop_requested()) {
    return nullptr;
  }
  leave_.emplace();
  return std::make_unique<Leave>(*this, leave_->get_token());
}

void Scanner::take_leave_back() {
  const std::lock_guard lock(mutex_);
  leave_.reset();
  wake_.notify_all();
}

bool Scanner::lend_rig(const std::function<void(Rig& rig, const std::stop_token& stop)>& use) {
  Loan loan{.use = use};
  std::unique_lock lock(mutex_);
  const auto is_ending = [&] { return worker_.get_stop_token().stop_requested(); };
  wake_.wait(lock, [&] { return loan_ == nullptr || order_ || is_ending(); });
  if (loan_ != nullptr || order_ || is_ending()) {
    return false;
  }
  loan_ = &loan;
  wake_.notify_all();
  wake_.wait(lock, [&] { return loan.done || (order_ && !loan.taken); });
  if (!loan.done) {
    loan_ = nullptr;  // the scan is first
  }
  if (loan.failure) {
    std::rethrow_exception(loan.failure);
  }
  return loan.used;
}

void Scanner::request_stop() {
  worker_.request_stop();
  const std::lock_guard lock(mutex_);
  if (leave_) {
    leave_->request_stop();
  }
}

Status Scanner::status() const {
  Status status = *status_.get();
  if (status.busy()) {
    const Clock::time_point now = Clock::now();
    status.job->elapsed = now - status.job_started;
    if (status.job_end) {
      status.job->left = std::max(*status.job_end - now, Clock::duration::zero());
    }
  }
  return status;
}

Status Scanner::wait_until_done(std::chrono::milliseconds patience) const {
  status_.wait(worker_.get_stop_token(), patience,
               [](const Status& status) { return !status.busy(); });
  return status();
}

std::shared_ptr<const View> Scanner::view() {
  const bool scanning = status_.get()->busy();
  const Clock::time_point asked = Clock::now();
  {
    const std::lock_guard lock(mutex_);
    view_wanted_until_ = asked + view_interest;
  }
  wake_.notify_all();
  auto view = view_.wait(worker_.get_stop_token(), view_patience, [&](const View& latest) {
    const auto age = asked - latest.time;
    return latest.failure ? age < retry_interval
                          : age < fresh || (scanning && latest.depth_unit > 0);
  });
  if (view->failure) {
    throw Error(view->failure->code, view->failure->detail, view->failure->hint);
  }
  if (!scanning && asked - view->time >= fresh) {
    throw Error("sensor-silent", "the sensor has sent no frame yet", "Try again in a moment.");
  }
  return view;
}

void Scanner::work(const std::stop_token& stop) {
  Rig rig(rig_options_);
  look_for_turntable(rig);  // so that the status tells what is there
  look(rig, stop);
  while (!stop.stop_requested()) {
    switch (wait_for_demand(stop)) {
      case Demand::scan:
        run_order(rig, stop);
        break;
      case Demand::view:
        look(rig, stop);
        break;
      case Demand::loan:
        lend(rig, stop);
        break;
      case Demand::none:
        rig.close_sensor();
        break;
    }
  }
  end_loan();
}

Scanner::Demand Scanner::wait_for_demand(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  const auto viewed = [&] { return Clock::now() < view_wanted_until_; };
  wake_.wait_for(lock, stop, open_without_use,
                 [&] { return order_ || loan_ != nullptr || viewed(); });
  if (stop.stop_requested()) {
    return Demand::none;
  }
  return order_             ? Demand::scan
         : loan_ != nullptr ? Demand::loan
         : viewed()         ? Demand::view
                            : Demand::none;
}

void Scanner::look(Rig& rig, const std::stop_token& stop) {
  try {
    DepthSensor& sensor = rig.sensor();
    if (const std::optional<TimedFrame> timed = sensor.read(stop)) {
      set_view(timed->frame, sensor.intrinsics().depth_unit);
      set_sensor_ready(sensor.name());
    }
  } catch (const Error& error) {
    rig.close_sensor();
    set_device_failed(failure_of(error));
    std::unique_lock lock(mutex_);
    wake_.wait_for(lock, stop, retry_interval, [&] { return order_ || loan_ != nullptr; });
  }
}

void Scanner::look_for_turntable(Rig& rig) {
  try {
    rig.turntable();
    set_turntable_ready();
  } catch (const Error& error) {
    set_device_failed(failure_of(error));
  }
}

void Scanner::run_order(Rig& rig, const std::stop_token& stop) {
  Job job;
  std::stop_source cancel;
  {
    const std::lock_guard lock(mutex_);
    job = order_->job;
    cancel = order_->cancel;
  }
  const std::stop_callback end_with_the_daemon(stop, [&] { cancel.request_stop(); });
  {
    std::unique_lock lock(mutex_);
    wake_.wait(lock, cancel.get_token(), [&] { return !leave_; });
  }
  log::info("scanner",
            "scan " + job.id + " started, snapshots=" + std::to_string(job.settings.snapshots));
  look_for_turntable(rig);  // whose lines may have become free since
  try {
    job.model =
        run_scan(job.settings, limits_, store_.folder(job.id), rig, cancel.get_token(),
                 {.on_progress = [&](Phase phase, int done) { report(phase, done); },
                  .on_frame =
                      [&](const DepthFrame& frame, double depth_unit) {
                        set_view(frame, depth_unit);
                        set_sensor_ready(rig.sensor().name());
                      },
                  .on_added = [&](const Reconstruction& seen,
                                  int snapshots) { set_preview(job.id, seen, snapshots); }});
    job.state = job.model ? JobState::finished : JobState::cancelled;
    if (!job.model && stop.stop_requested()) {
      job.state = JobState::interrupted;
      job.failure = interruption();
    }
  } catch (const Error& error) {
    job.state = JobState::failed;
    job.failure = failure_of(error);
    set_device_failed(*job.failure);
    if (error.code().starts_with("sensor-")) {
      rig.close_sensor();
    }
  } catch (const std::exception& error) {
    job.state = JobState::failed;
    job.failure =
        Failure{.code = "internal", .detail = error.what(), .hint = "Please report this."};
  }
  let_go(rig);
  finish(std::move(job));
}

void Scanner::lend(Rig& rig, const std::stop_token& stop) {
  Loan* loan = nullptr;
  {
    const std::lock_guard lock(mutex_);
    if (loan_ == nullptr) {
      return;  // a scan has come before it
    }
    loan = loan_;
    loan->taken = true;
  }
  const std::stop_callback end_with_the_daemon(stop, [&] { loan->stop.request_stop(); });
  try {
    loan->use(rig, loan->stop.get_token());
    loan->used = true;
  } catch (...) {
    loan->failure = std::current_exception();
  }
  end_loan();
}

/// Lets whoever waits for the rig go on, with it or without.
void Scanner::end_loan() {
  const std::lock_guard lock(mutex_);
  if (loan_ != nullptr) {
    loan_->done = true;
    loan_ = nullptr;
  }
  wake_.notify_all();
}

void Scanner::let_go(Rig& rig) {
  try {
    rig.release_turntable();
  } catch (const Error& error) {
    set_device_failed(failure_of(error));
  }
}

void Scanner::report(Phase phase, int snapshots_done) {
  status_.update([&](Status& status) {
    status.job->phase = phase;
    status.job->snapshots_done = snapshots_done;
    if (snapshots_done > 0) {
      const Clock::time_point now = Clock::now();
      const auto each = (now - status.job_started) / snapshots_done;
      status.job_end = now + each * (status.job->settings.snapshots - snapshots_done);
    }
  });
}

void Scanner::finish(Job job) {
  const Status latest = status();
  job.phase = Phase::done;
  job.snapshots_done = latest.job->snapshots_done;
  job.elapsed = latest.job->elapsed;
  if (job.state == JobState::failed) {
    log::error("scanner", "scan " + job.id + " failed: " + job.failure->detail);
  } else {
    log::info("scanner", "scan " + job.id + " " + std::string(name_of(job.state)));
  }
  try {
    store_.save(job);
  } catch (const Error& error) {
    // On the disk it still runs, and the next start will call it interrupted.
    log::error("scanner", error.what());
  }
  const std::lock_guard lock(mutex_);
  status_.update([&](Status& status) { status.job = std::move(job); });
  order_.reset();
}

void Scanner::set_view(const DepthFrame& frame, double depth_unit) {
  view_.set({.time = Clock::now(), .frame = frame, .depth_unit = depth_unit});
}

void Scanner::set_preview(const std::string& id, const Reconstruction& seen, int snapshots) {
  std::vector<Facet> facets;
  seen.preview(preview_leaf_size, most_preview_facets, [&](std::span<const Facet> some) {
    facets.insert(facets.end(), some.begin(), some.end());
  });
  if (!facets.empty()) {
    preview_.set({.id = id, .snapshots = snapshots, .stl = stl_text(facets)});
  }
}

void Scanner::set_sensor_ready(const std::string& name) {
  if (status_.get()->sensor.state == DeviceStatus::State::ready) {
    return;
  }
  log::info("scanner", "sensor ready: " + name);
  status_.update([&](Status& status) {
    status.sensor.state = DeviceStatus::State::ready;
    status.sensor.name = name;
    status.sensor.message.clear();
  });
}

void Scanner::set_turntable_ready() {
  if (status_.get()->turntable.state == DeviceStatus::State::ready) {
    return;
  }
  log::info("scanner", "turntable ready: " + status_.get()->turntable.name);
  status_.update([&](Status& status) {
    status.turntable.state = DeviceStatus::State::ready;
    status.turntable.message.clear();
  });
}

void Scanner::set_device_failed(const Failure& failure) {
  const bool sensor = failure.code.starts_with("sensor-");
  if (sensor) {
    view_.set({.time = Clock::now(), .failure = failure});
  }
  if (!sensor && !failure.code.starts_with("turntable-")) {
    return;  // a disk or a setting
  }
  status_.update([&](Status& status) {
    DeviceStatus& device = sensor ? status.sensor : status.turntable;
    if (device.message != failure.detail) {
      log::warning("scanner", failure.detail);
    }
    device.state = state_for(failure.code);
    device.message = failure.detail;
  });
}

}  // namespace octurn
