#include "run/command_slot.hpp"

#include <type_traits>
#include <utility>

#include "log.hpp"
#include "octurn/error.hpp"
#include "octurn/model.hpp"
#include "octurn/scan_folder.hpp"
#include "octurn/snapshot.hpp"
#include "octurn/stl.hpp"
#include "store/stored_scan.hpp"

namespace octurn {

void ModelPipe::set_length(std::uint64_t bytes) {
  {
    const std::lock_guard lock(mutex_);
    length_ = bytes;
  }
  changed_.notify_all();
}

void ModelPipe::write(std::span<const std::byte> bytes) {
  if (bytes.empty()) {
    return;  // an empty block marks the end
  }
  {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, stop_.get_token(), [&] { return held_bytes_ < max_bytes; });
    if (stop_.stop_requested()) {
      throw Stopped{};
    }
    blocks_.emplace_back(bytes.begin(), bytes.end());
    held_bytes_ += bytes.size();
  }
  changed_.notify_all();
}

void ModelPipe::close() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  changed_.notify_all();
}

void ModelPipe::fail(Failure reason) {
  {
    const std::lock_guard lock(mutex_);
    failure_ = std::move(reason);
    closed_ = true;
  }
  changed_.notify_all();
}

std::uint64_t ModelPipe::length() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, stop_.get_token(), [&] { return length_ || closed_; });
  if (failure_) {
    throw to_error(*failure_);
  }
  if (!length_ || stop_.stop_requested()) {
    throw Error(ErrorCode::busy, "a scan has started", "Wait for its end.");
  }
  return *length_;
}

std::vector<std::byte> ModelPipe::read() {
  std::vector<std::byte> block;
  {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, stop_.get_token(), [&] { return !blocks_.empty() || closed_; });
    if (stop_.stop_requested() || blocks_.empty()) {
      return {};
    }
    block = std::move(blocks_.front());
    blocks_.pop_front();
    held_bytes_ -= block.size();
  }
  changed_.notify_all();
  return block;
}

ModelStream::ModelStream(std::shared_ptr<ModelPipe> pipe) : pipe_(std::move(pipe)) {
  try {
    bytes_ = pipe_->length();
  } catch (...) {
    pipe_->stop().request_stop();
    throw;
  }
}

ModelStream::~ModelStream() { pipe_->stop().request_stop(); }

void ModelStream::send(const std::function<bool(std::span<const std::byte>)>& sink) {
  for (std::vector<std::byte> block = pipe_->read(); !block.empty() && sink(block);
       block = pipe_->read()) {
  }
}

namespace {

Rank to_rank(const Command& command) {
  return std::visit([](const auto& one) { return std::decay_t<decltype(one)>::rank; }, command);
}

}  // namespace

CommandSlot::Subject CommandSlot::to_subject(const Command& command) {
  Subject subject{.rank = to_rank(command),
                  .is_lens = std::holds_alternative<LensCommand>(command)};
  if (const auto* const scan = std::get_if<ScanCommand>(&command)) {
    subject.scan = scan->job.id;
  } else if (const auto* const resumed = std::get_if<ResumeCommand>(&command)) {
    subject.scan = resumed->job.id;
  } else if (const auto* const build = std::get_if<BuildCommand>(&command)) {
    subject.scan = build->run.scan;
    subject.build = build->run.number;
  }
  return subject;
}

/// Whether the waiting or the running command matches.
template <typename Matches>
bool CommandSlot::has(Matches matches) const {
  const std::lock_guard lock(mutex_);
  return (waiting_ && matches(to_subject(waiting_->command))) || (running_ && matches(*running_));
}

/// Whether no command of that rank or a higher one waits or runs; `mutex_` is held.
bool CommandSlot::rank_is_free(Rank rank) const {
  return !ended_ && (!waiting_ || to_rank(waiting_->command) < rank) &&
         (!running_ || running_->rank < rank);
}

/// Replaces the waiting command; `mutex_` is held.
void CommandSlot::put(Command command, std::stop_source stop) {
  if (waiting_) {
    waiting_->stop.request_stop();
  }
  const bool is_scan = to_rank(command) == Rank::scan;
  waiting_.emplace(Taken{std::move(command), std::move(stop)});
  if (running_ && (is_scan || running_->rank == Rank::camera)) {
    stop_.request_stop();
  }
  changed_.notify_all();
}

/// Puts a command into the slot unless one of its rank or a higher one waits or runs.
bool CommandSlot::offer(Command command) {
  const std::lock_guard lock(mutex_);
  if (!rank_is_free(to_rank(command))) {
    return false;
  }
  put(std::move(command), {});
  return true;
}

bool CommandSlot::offer_scan(Command scan) { return offer(std::move(scan)); }

bool CommandSlot::offer_build(BuildCommand build) { return offer(std::move(build)); }

bool CommandSlot::offer_rebuild(RebuildCommand rebuild, std::stop_source stop,
                                Clock::duration patience) {
  std::unique_lock lock(mutex_);
  const auto is_free = [&] { return !waiting_ && rank_is_free(Rank::rebuild); };
  if (!std::exchange(rebuild_waits_, true)) {
    changed_.wait_for(lock, patience, [&] { return is_free() || !rank_is_free(Rank::build); });
    rebuild_waits_ = false;
  }
  if (!is_free()) {
    return false;
  }
  put(std::move(rebuild), std::move(stop));
  return true;
}

bool CommandSlot::offer_check(DeviceCheckCommand check) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return rank_is_free(Rank::check) || !rank_is_free(Rank::rebuild); });
  if (!rank_is_free(Rank::rebuild)) {
    return false;
  }
  put(std::move(check), {});
  return true;
}

void CommandSlot::want_camera(Clock::time_point until) {
  {
    const std::lock_guard lock(mutex_);
    camera_wanted_until_ = until;
  }
  changed_.notify_all();
}

ScanStop CommandSlot::scan_stop() const {
  const std::lock_guard lock(mutex_);
  return scan_stop_;
}

void CommandSlot::stop_scan(ScanStop why) {
  const std::lock_guard lock(mutex_);
  scan_stop_ = why;
  if (waiting_ && to_rank(waiting_->command) == Rank::scan) {
    waiting_->stop.request_stop();
  }
  if (running_ && running_->rank == Rank::scan) {
    stop_.request_stop();
  }
}

bool CommandSlot::stop_build() {
  const std::lock_guard lock(mutex_);
  if (waiting_ && to_rank(waiting_->command) == Rank::build) {
    waiting_.reset();
    changed_.notify_all();
    return true;
  }
  if (running_ && running_->rank == Rank::build) {
    stop_.request_stop();
  }
  return false;
}

bool CommandSlot::solve_lens() {
  const std::lock_guard lock(mutex_);
  if (!running_ || !running_->has_views) {
    return false;
  }
  scan_stop_ = ScanStop::pause;
  stop_.request_stop();
  return true;
}

bool CommandSlot::has_scan() const {
  return has([](const Subject& subject) { return subject.rank == Rank::scan; });
}

bool CommandSlot::has_scan(std::string_view id) const {
  return has(
      [&](const Subject& subject) { return subject.rank == Rank::scan && subject.scan == id; });
}

bool CommandSlot::has_measurement() const {
  return has([](const Subject& subject) { return subject.rank == Rank::scan && !subject.scan; });
}

bool CommandSlot::is_busy() const {
  return has([](const Subject& subject) { return subject.rank >= Rank::build; });
}

bool CommandSlot::has_build(std::string_view scan, std::optional<int> number) const {
  return has([&](const Subject& subject) {
    return subject.rank == Rank::build && subject.scan == scan &&
           subject.build == number.value_or(subject.build);
  });
}

bool CommandSlot::is_occupied() const {
  const std::lock_guard lock(mutex_);
  return !rank_is_free(Rank::rebuild);
}

void CommandSlot::end() {
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
    stop_.request_stop();
    if (waiting_) {
      waiting_->stop.request_stop();
    }
  }
  changed_.notify_all();
}

bool CommandSlot::has_ended() const {
  const std::lock_guard lock(mutex_);
  return ended_;
}

std::optional<CommandSlot::Taken> CommandSlot::take(Clock::duration patience) {
  std::unique_lock lock(mutex_);
  const auto camera_is_wanted = [&] { return Clock::now() < camera_wanted_until_; };
  changed_.wait_for(lock, patience, [&] { return waiting_ || ended_ || camera_is_wanted(); });
  std::optional<Taken> taken = std::exchange(waiting_, std::nullopt);
  if (!taken && !ended_ && camera_is_wanted()) {
    taken = Taken{};
  }
  if (taken) {
    running_ = to_subject(taken->command);
    stop_ = taken->stop;
    if (ended_) {
      stop_.request_stop();
    }
  }
  changed_.notify_all();
  return taken;
}

void CommandSlot::report_lens_view() {
  const std::lock_guard lock(mutex_);
  if (running_ && running_->is_lens) {
    running_->has_views = true;
  }
}

void CommandSlot::finish() {
  {
    const std::lock_guard lock(mutex_);
    running_.reset();
  }
  changed_.notify_all();
}

void CommandSlot::wait_for_command(Clock::duration patience) {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, stop_.get_token(), patience,
                    [&] { return waiting_.has_value() || ended_; });
}

void make_model(const std::filesystem::path& folder, ReconstructOptions options, ModelPipe& pipe) {
  const std::stop_token stop = pipe.stop().get_token();
  ModelInput input{.folder = folder,
                   .scan = read_scan(folder),
                   .options = std::move(options),
                   .solves_pose = false,
                   .is_judged = false};
  input.options.clip = model_clip(input.scan);
  input.snapshots = [&](const Scan& scan) { return readable_snapshots(folder, scan, stop); };
  input.write = [&](Reconstructor& reconstructor, const SnapshotSource& snapshots) {
    const SurfaceCount count = reconstructor.count(snapshots, stop);
    expect_facets(count.facets);
    pipe.set_length(stl_bytes(count.facets));
    pipe.write(stl_header(count.facets));
    const auto send = [&](std::span<const Facet> facets) { pipe.write(std::as_bytes(facets)); };
    reconstructor.surface(snapshots, send, stop);
    pipe.close();
    return std::optional<ModelReport>();
  };
  build_model(std::move(input), stop);
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
