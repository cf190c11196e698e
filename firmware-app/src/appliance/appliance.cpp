#include "appliance/appliance.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>

#include "octurn/error.hpp"
#include "octurn/json_object.hpp"

namespace octurn {
namespace {

using std::chrono::sys_seconds;

// A client whose time is outside this range has no valid clock either.
constexpr sys_seconds earliest = std::chrono::sys_days(std::chrono::year(2026) / 1 / 1);
constexpr sys_seconds latest = std::chrono::sys_days(std::chrono::year(2100) / 1 / 1);

double to_number(sys_seconds time) { return static_cast<double>(time.time_since_epoch().count()); }

}  // namespace

sys_seconds clock_from(const nlohmann::json& body) {
  JsonObject keys(body, ErrorCode::bad_settings, "");
  const double seconds_since_1970 =
      keys.at("unix_s").number(to_number(earliest), to_number(latest));
  keys.refuse_unread();
  return sys_seconds(
      std::chrono::seconds(static_cast<std::chrono::seconds::rep>(seconds_since_1970)));
}

std::string to_text(const ControlRequest& request) {
  if (const auto* time = std::get_if<sys_seconds>(&request)) {
    return "clock " + std::to_string(time->time_since_epoch().count()) + "\n";
  }
  return std::get<PowerEnd>(request) == PowerEnd::restart ? "restart\n" : "off\n";
}

namespace {

constexpr std::size_t max_host_name = 63;  // bytes of a label: RFC 1035, 2.3.4
constexpr std::size_t max_zone_name = 64;

bool is_host_character(char c) {
  return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-';
}

bool is_zone_character(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 ||
         std::string_view("_+/-").find(c) != std::string_view::npos;
}

/// @throws Error "bad-settings"  if the value is not a valid host name
std::string to_host_name(const JsonValue& value) {
  std::string name = value.text();
  std::ranges::transform(name, name.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (name.empty() || name.size() > max_host_name || name.starts_with('-') || name.ends_with('-') ||
      !std::ranges::all_of(name, is_host_character)) {
    value.refuse("letters, digits and hyphens between them, at most 63");
  }
  return name;
}

/// Checks the characters of a zone's name. Root checks whether the zone exists.
std::string to_zone(const JsonValue& value) {
  std::string zone = value.text();
  if (zone.empty() || zone.size() > max_zone_name ||
      !std::ranges::all_of(zone, is_zone_character)) {
    value.refuse("a continent and a city, such as Europe/Berlin");
  }
  return zone;
}

}  // namespace

MachineRequest machine_request_from(const nlohmann::json& body) {
  JsonObject keys(body, ErrorCode::bad_settings, "");
  MachineRequest request;
  if (const auto name = keys.value("name")) {
    request.name = to_host_name(*name);
  }
  if (const auto zone = keys.value("time_zone")) {
    request.time_zone = to_zone(*zone);
  }
  keys.refuse_unread();
  if (!request.name && !request.time_zone) {
    throw Error(ErrorCode::bad_settings, "the body has neither name nor time_zone");
  }
  return request;
}

std::string to_text(const MachineRequest& request) {
  return (request.name ? "name = " + *request.name + "\n" : "") +
         (request.time_zone ? "time_zone = " + *request.time_zone + "\n" : "");
}

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
