#pragma once

#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

namespace octurn {

/// Every kind of error that the library and the program report. Other programs know them by the
/// words of `to_string`, such as "disk-full" for `disk_full`: a word never changes its meaning.
enum class ErrorCode {
  // Settings, requests and their bodies
  bad_config,
  bad_json,
  bad_name,
  bad_password,
  bad_password_file,
  bad_range,
  bad_request,
  bad_settings,
  bad_simulation,
  bad_wifi,
  changed,
  cut_short,
  length_required,
  not_found,
  password_needed,
  too_large,
  too_many,
  too_many_guesses,
  too_slow,
  wrong_content_type,
  wrong_host,
  wrong_method,
  wrong_origin,
  // Scans and models
  busy,
  interrupted,
  memory_limit,
  model_empty,
  model_too_large,
  no_model,
  no_preview,
  no_such_scan,
  not_paused,
  not_running,
  stopped,
  // Files and disks
  data_failed,
  data_in_use,
  disk_full,
  file_too_large,
  job_malformed,
  mesh_malformed,
  no_space,
  page_missing,
  platform_malformed,
  read_failed,
  recording_malformed,
  scan_empty,
  scan_malformed,
  scan_missing,
  snapshot_malformed,
  write_failed,
  // Devices
  sensor_blind,
  sensor_failed,
  sensor_lost,
  sensor_missing,
  sensor_other,
  sensor_silent,
  turntable_failed,
  turntable_lost,
  turntable_missing,
  // The machine and the program
  internal,
  listen_failed,
  no_descriptors,
  not_an_appliance,
  not_root,
  update_failed,
  unknown,  ///< read from a file that a newer version wrote
};

/// The word for programs, such as "scan-malformed".
std::string_view to_string(ErrorCode code);

/// The code of a word, if there is one.
std::optional<ErrorCode> to_error_code(std::string_view word);

/// The values in a message by name, from which a translated message is made. A name ends with its
/// unit, as in "disagreement_mm"; a share is 0 to 1.
using Parameters = std::map<std::string, std::variant<double, std::string>>;

/// An error outside this program: of a file, a device, a disk, a setting.
///
/// `what()` is one line that includes the values; `hint()` says what a person can do about it, or
/// is empty; `parameters()` has the values again, for translations.
class Error : public std::runtime_error {
 public:
  explicit Error(ErrorCode code, const std::string& message, std::string hint = {},
                 Parameters parameters = {})
      : std::runtime_error(message),
        code_(code),
        hint_(std::move(hint)),
        parameters_(std::move(parameters)) {}

  ErrorCode code() const { return code_; }
  const std::string& hint() const { return hint_; }
  const Parameters& parameters() const { return parameters_; }

 private:
  ErrorCode code_;
  std::string hint_;
  Parameters parameters_;
};

}  // namespace octurn
