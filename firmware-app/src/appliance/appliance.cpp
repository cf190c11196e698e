#include "appliance/appliance.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <map>
#include <system_error>
#include <utility>

#include "octurn/error.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t max_answer_bytes = std::size_t{256} << 10U;  // bytes; root's are far smaller
constexpr unsigned private_mode = 0600;
constexpr auto patience_with_root = std::chrono::seconds(30);

/// The last bytes of a file; empty if there is none.
std::string read_end(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary | std::ios::ate);
  const auto bytes = static_cast<std::streamoff>(stream.tellg());
  std::string text(
      std::min<std::size_t>(bytes > 0 ? static_cast<std::size_t>(bytes) : 0, max_answer_bytes),
      '\0');
  stream.seekg(bytes - static_cast<std::streamoff>(text.size()));
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(std::max<std::streamsize>(stream.gcount(), 0)));
  return text;
}

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view blanks = " \t\r";
  const std::size_t begin = std::min(text.find_first_not_of(blanks), text.size());
  return text.substr(begin, text.find_last_not_of(blanks) + 1 - begin);
}

using Settings = std::map<std::string, std::string, std::less<>>;

/// Parses an answer's lines `key = value`.
Settings settings_in(const fs::path& file) {
  Settings settings;
  std::ifstream stream(file, std::ios::binary);
  for (std::string line; std::getline(stream, line) && line.size() < max_answer_bytes;) {
    if (const std::size_t equals = line.find('='); equals != std::string::npos) {
      const std::string_view whole = line;
      settings.insert_or_assign(std::string(trimmed(whole.substr(0, equals))),
                                std::string(trimmed(whole.substr(equals + 1))));
    }
  }
  return settings;
}

std::string value_in(const Settings& settings, std::string_view key) {
  const auto found = settings.find(key);
  return found == settings.end() ? "" : found->second;
}

/// The answer's state; "none" if it is not one of `known`.
template <std::size_t count>
std::string known_state(const Settings& settings,
                        const std::array<std::string_view, count>& known) {
  const std::string state = value_in(settings, "state");
  return std::ranges::find(known, state) == known.end() ? "none" : state;
}

/// Whether root is installing an update: the machine may restart at any moment.
bool is_being_installed(const UpdateState& update) {
  return update.state == "installing" || update.state == "restarting";
}

[[noreturn]] void throw_no_space() {
  throw Error(ErrorCode::no_space, "there is no room for the update in the scanner's memory",
              "Switch the scanner off and on, and try again.");
}

/// Writes to the requests, which are in memory: "disk-full" there means too little memory.
template <typename Action>
void in_memory(const Action& action) {
  try {
    action();
  } catch (const Error& error) {
    if (error.code() == ErrorCode::disk_full) {
      throw_no_space();
    }
    throw;
  }
}

}  // namespace

Appliance::Appliance(fs::path folder) : folder_(std::move(folder)) {
  std::error_code ignored;  // if the folder is missing, the first request throws
  for (const fs::directory_entry& entry : fs::directory_iterator(request(""), ignored)) {
    if (entry.path().filename().string().starts_with('.')) {
      fs::remove(entry.path(), ignored);
    }
  }
}

fs::path Appliance::request(std::string_view name) const { return folder_ / "requests" / name; }

UpdateState Appliance::update() const {
  UpdateState update = answered_update();
  return is_receiving_ ? UpdateState{.slot = update.slot, .state = "receiving"} : update;
}

/// The update's state by root's answer. A request that root has not taken yet counts as installing.
UpdateState Appliance::answered_update() const {
  constexpr std::array<std::string_view, 6> states{"installing", "restarting", "failed",
                                                   "trial",      "kept",       "returned"};
  std::error_code ignored;
  const bool is_waiting = fs::exists(request("update"), ignored);  // before the answer is read
  const Settings answer = settings_in(folder_ / "update");
  UpdateState update{.slot = value_in(answer, "slot"),
                     .state = known_state(answer, states),
                     .version = value_in(answer, "version"),
                     .error = value_in(answer, "error")};
  return is_waiting && !is_being_installed(update)
             ? UpdateState{.slot = update.slot, .state = "installing"}
             : update;
}

bool Appliance::is_updating() const {
  return is_receiving_ || is_being_installed(answered_update());
}

/// The requested WiFi, until root has answered or 30 s have passed. The request file does not show
/// this: root removes it long before it answers.
std::optional<WifiRequest> Appliance::unanswered_wifi() const {
  const std::scoped_lock lock(mutex_);
  std::error_code ignored;  // the time of a missing answer is the minimum, before any request
  const bool is_waiting = asked_ && std::chrono::steady_clock::now() < asked_->until &&
                          fs::last_write_time(folder_ / "wifi", ignored) < asked_->time;
  return is_waiting ? std::optional(asked_->wifi) : std::nullopt;
}

WifiState Appliance::wifi() const {
  constexpr std::array<std::string_view, 4> states{"joining", "joined", "failed", "hotspot"};
  const auto asked = unanswered_wifi();  // before the answer is read
  const Settings answer = settings_in(folder_ / "wifi");
  WifiState wifi{.state = known_state(answer, states),
                 .name = value_in(answer, "name"),
                 .country = value_in(answer, "country"),
                 .hotspot = value_in(answer, "hotspot"),
                 .error = value_in(answer, "error"),
                 .networks = wifi_networks(read_end(folder_ / "networks"))};
  if (asked) {
    wifi.state = "joining";
    wifi.name = asked->name;
    wifi.country = asked->country;
    wifi.error = {};
  }
  return wifi;
}

MachineState Appliance::machine() const {
  const Settings answer = settings_in(folder_ / "machine");
  return {.name = value_in(answer, "name"),
          .time_zone = value_in(answer, "time_zone"),
          .error = value_in(answer, "error")};
}

void Appliance::ask_for_machine(const MachineRequest& machine) {
  write_file(request("machine"), to_text(machine), private_mode);
}

void Appliance::ask_for_control(const ControlRequest& control) {
  write_file(request("control"), to_text(control), private_mode);
}

std::string Appliance::errors() const { return read_end(folder_ / "errors"); }

void Appliance::ask_for_wifi(const WifiRequest& wifi) {
  const std::scoped_lock lock(mutex_);
  const Asked asked{.wifi = {.name = wifi.name, .country = wifi.country},
                    .time = fs::file_time_type::clock::now(),
                    .until = std::chrono::steady_clock::now() + patience_with_root};
  write_file(request("wifi"), to_text(wifi), private_mode);
  asked_ = asked;
}

Appliance::Upload::Turn::Turn(std::atomic<bool>& is_taken) : is_taken_(is_taken) {
  if (is_taken.exchange(true)) {
    throw Error(ErrorCode::busy, "another update is being received", "Wait for its end.");
  }
}

Appliance::Upload::Upload(Appliance& appliance, std::uint64_t bytes, UpdateAge age)
    : turn_(appliance.is_receiving_),
      file_(appliance.place_for_update(bytes), private_mode),
      older_(appliance.request("update.older")),
      age_(age) {}

void Appliance::Upload::write(std::span<const std::byte> bytes) {
  in_memory([&] { file_.write(bytes); });
}

void Appliance::Upload::commit() {
  in_memory([&] {
    if (age_ == UpdateAge::any) {
      write_file(older_, "", private_mode);
    } else {
      fs::remove(older_);
    }
    file_.commit();
  });
}

fs::path Appliance::place_for_update(std::uint64_t bytes) const {
  if (bytes > Upload::max_bytes) {
    throw Error(ErrorCode::too_large, "an update has at most 160 MiB, and this file has more",
                "Choose the file octurn-VERSION.update of a release.");
  }
  const UpdateState last = answered_update();
  if (is_being_installed(last)) {
    throw Error(ErrorCode::busy, "another update is being installed", "Wait for its end.");
  }
  if (last.state == "trial") {
    throw Error(ErrorCode::busy, "the last update is still on trial",
                "Try again in a few minutes.");
  }
  std::error_code unknown;  // if set, a lack of space shows when writing
  if (const fs::space_info memory = fs::space(request(""), unknown);
      !unknown && memory.available < bytes) {
    throw_no_space();
  }
  return request("update");
}

}  // namespace octurn
