#include "octurn/error.hpp"

#include <algorithm>
#include <array>

namespace octurn {
namespace {

struct Word {
  ErrorCode code;
  std::string_view text;
};

constexpr std::array<Word, 67> words{{
    {ErrorCode::bad_config, "bad-config"},
    {ErrorCode::bad_json, "bad-json"},
    {ErrorCode::bad_name, "bad-name"},
    {ErrorCode::bad_password, "bad-password"},
    {ErrorCode::bad_password_file, "bad-password-file"},
    {ErrorCode::bad_range, "bad-range"},
    {ErrorCode::bad_request, "bad-request"},
    {ErrorCode::bad_settings, "bad-settings"},
    {ErrorCode::bad_simulation, "bad-simulation"},
    {ErrorCode::bad_wifi, "bad-wifi"},
    {ErrorCode::changed, "changed"},
    {ErrorCode::cut_short, "cut-short"},
    {ErrorCode::length_required, "length-required"},
    {ErrorCode::not_found, "not-found"},
    {ErrorCode::password_needed, "password-needed"},
    {ErrorCode::too_large, "too-large"},
    {ErrorCode::too_many, "too-many"},
    {ErrorCode::too_many_guesses, "too-many-guesses"},
    {ErrorCode::too_slow, "too-slow"},
    {ErrorCode::wrong_content_type, "wrong-content-type"},
    {ErrorCode::wrong_host, "wrong-host"},
    {ErrorCode::wrong_method, "wrong-method"},
    {ErrorCode::wrong_origin, "wrong-origin"},
    {ErrorCode::busy, "busy"},
    {ErrorCode::interrupted, "interrupted"},
    {ErrorCode::memory_limit, "memory-limit"},
    {ErrorCode::model_empty, "empty"},        // as in `QualityReason::code`
    {ErrorCode::model_empty, "model-empty"},  // in job.json of version 0.1
    {ErrorCode::model_too_large, "model-too-large"},
    {ErrorCode::no_model, "no-model"},
    {ErrorCode::no_preview, "no-preview"},
    {ErrorCode::no_such_scan, "no-such-scan"},
    {ErrorCode::not_paused, "not-paused"},
    {ErrorCode::not_running, "not-running"},
    {ErrorCode::stopped, "stopped"},
    {ErrorCode::data_failed, "data-failed"},
    {ErrorCode::data_in_use, "data-in-use"},
    {ErrorCode::disk_full, "disk-full"},
    {ErrorCode::file_too_large, "file-too-large"},
    {ErrorCode::job_malformed, "job-malformed"},
    {ErrorCode::mesh_malformed, "mesh-malformed"},
    {ErrorCode::no_space, "no-space"},
    {ErrorCode::page_missing, "page-missing"},
    {ErrorCode::platform_malformed, "platform-malformed"},
    {ErrorCode::read_failed, "read-failed"},
    {ErrorCode::recording_malformed, "recording-malformed"},
    {ErrorCode::scan_empty, "scan-empty"},
    {ErrorCode::scan_malformed, "scan-malformed"},
    {ErrorCode::scan_missing, "scan-missing"},
    {ErrorCode::snapshot_malformed, "snapshot-malformed"},
    {ErrorCode::write_failed, "write-failed"},
    {ErrorCode::sensor_blind, "sensor-blind"},
    {ErrorCode::sensor_failed, "sensor-failed"},
    {ErrorCode::sensor_lost, "sensor-lost"},
    {ErrorCode::sensor_missing, "sensor-missing"},
    {ErrorCode::sensor_other, "sensor-other"},
    {ErrorCode::sensor_silent, "sensor-silent"},
    {ErrorCode::turntable_failed, "turntable-failed"},
    {ErrorCode::turntable_lost, "turntable-lost"},
    {ErrorCode::turntable_missing, "turntable-missing"},
    {ErrorCode::internal, "internal"},
    {ErrorCode::listen_failed, "listen-failed"},
    {ErrorCode::no_descriptors, "no-descriptors"},
    {ErrorCode::not_an_appliance, "not-an-appliance"},
    {ErrorCode::not_root, "not-root"},
    {ErrorCode::update_failed, "update-failed"},
    {ErrorCode::unknown, "unknown"},
}};

}  // namespace

std::string_view to_string(ErrorCode code) {
  const auto* const found = std::ranges::find(words, code, &Word::code);
  return found == words.end() ? "unknown" : found->text;
}

std::optional<ErrorCode> to_error_code(std::string_view word) {
  const auto* const found = std::ranges::find(words, word, &Word::text);
  return found == words.end() ? std::nullopt : std::optional(found->code);
}

}  // namespace octurn
