#include "scan/scanner.hpp"

#include <utility>

namespace octurn {
namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

constexpr auto view_patience =
    15s;  // a sensor takes 1 to 2 s to its first frame, on a busy machine more
constexpr auto view_interest = 5s;  // frames are read for that long after someone asked
constexpr auto failure_lasts = 2s;  // so long a failure needs no other look
constexpr auto fresh = 200ms;       // a view of that age shows what is there now

}  // namespace

Scanner::Scanner(RigOptions rig, const Limits& limits, const ScanStore& store)
    : rig_options_(std::move(rig)), limits_(limits), store_(store), board_(rig_options_) {
  rig_options_.platform_angle_deg = store_.platform_angle_deg();
  worker_ = std::jthread([this](const std::stop_token& stop) { work(stop); });
}

std::optional<Job> Scanner::start(const ScanSettings& settings) {
  const std::lock_guard lock(mutex_);
  if (order_) {
    return std::nullopt;
  }
  const Job job = store_.create(settings);
  give_order(job);
  return job;
}

std::optional<Job> Scanner::resume(std::string_view id) {
  const std::lock_guard lock(mutex_);
  if (order_) {
    return std::nullopt;
  }
  std::optional<Job> job = store_.find(id);
  if (!job) {
    throw Error("no-such-scan", "there is no scan " + std::string(id));
  }
  if (!is_resumable(job->state)) {
    throw Error("not-paused", "this scan is " + std::string(name_of(job->state)),
                "Only a scan that was paused or interrupted can be resumed.");
  }
  job->state = JobState::running;
  job->phase = Phase::starting;
  job->failure.reset();
  store_.save(*job);
  give_order(*job);
  return job;
}

/// Fills the job slot, which is empty; `mutex_` is held.
void Scanner::give_order(const Job& job) {
  order_ = Order{.job = job};
  board_.set_job(job);
  if (leave_) {
    leave_->request_stop();
  }
  if (loan_ != nullptr) {
    loan_->stop.request_stop();
  }
  wake_.notify_all();
}

bool Scanner::cancel(std::string_view id) {
  const std::lock_guard lock(mutex_);
  if (order_ && order_->job.id == id) {
    order_->cancel.request_stop();
    return true;
  }
  std::optional<Job> job = store_.find(id);
  if (!job || !is_resumable(job->state)) {
    return false;
  }
  job->state = JobState::cancelled;
  job->failure.reset();
  store_.save(*job);
  board_.set_outcome(*job);
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

Status Scanner::wait_until_done(std::chrono::milliseconds patience) const {
  board_.latest_status().wait(worker_.get_stop_token(), patience,
                              [](const Status& status) { return !status.busy(); });
  return status();
}

std::shared_ptr<const View> Scanner::view() {
  const bool scanning = board_.latest_status().get()->busy();
  const Clock::time_point asked = Clock::now();
  {
    const std::lock_guard lock(mutex_);
    view_wanted_until_ = asked + view_interest;
  }
  wake_.notify_all();
  auto view = board_.view().wait(worker_.get_stop_token(), view_patience, [&](const View& latest) {
    const auto age = asked - latest.time;
    return latest.failure ? age < failure_lasts
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

void Scanner::expect_ready() {
  const auto failed = [](const DeviceStatus& device) {
    return device.state != DeviceStatus::State::ready;
  };
  Status now = status();
  if (!now.busy() && (failed(now.sensor) || failed(now.turntable))) {
    view();  // looks at both
    now = status();
  }
  if (!now.busy() && failed(now.turntable)) {
    const Failure& failure = now.turntable.failure;
    throw Error(failure.code, failure.detail, failure.hint);
  }
}

}  // namespace octurn
