#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "octurn/snapshot.hpp"

namespace octurn {

/// Origin of a depth sensor's optics.
enum class OpticsOrigin {
  turn,   ///< solved from a calibration turn
  scan,   ///< solved from a scan
  board,  ///< solved from views of a printed board, the scale of the depths as well
};

/// Optics of a depth sensor that are in force, or were.
struct OpticsRecord {
  SolvedOptics optics = {};
  OpticsOrigin origin = OpticsOrigin::turn;
  std::string at = {};  ///< UTC, as in ISO 8601
};

/// Number of earlier records that are kept of each sensor.
inline constexpr std::size_t max_optics_history = 10;

/// Returns the path of a sensor's optics: `optics/SERIAL.json`. Characters of the serial number
/// other than letters, digits, dots, dashes and underscores become underscores.
/// @param data  the data folder
std::filesystem::path optics_path(const std::filesystem::path& data, std::string_view serial);

/// Reads a sensor's optics: the record in force, then the earlier ones, newest first. Empty if
/// there are none: the optics are those that the sensor reports.
/// @throws Error "platform-malformed"  if the file is damaged; "read-failed"
std::vector<OpticsRecord> read_optics(const std::filesystem::path& data, std::string_view serial);

/// The same; a damaged file is logged, and counts as none.
std::vector<OpticsRecord> last_good_optics(const std::filesystem::path& data,
                                           std::string_view serial);

/// Puts optics into force. Of a damaged file no history remains.
/// @param serial  of the sensor; not empty
/// @throws Error "disk-full", "write-failed"
void keep_optics(const std::filesystem::path& data, std::string_view serial,
                 const OpticsRecord& record);

/// Restores the optics before those in force; before the first ones, those that the sensor reports.
/// @throws Error "not-found"  if none are kept; and as `read_optics` and `keep_optics`
void undo_optics(const std::filesystem::path& data, std::string_view serial);

/// Returns the record in force. A damaged file is logged, and counts as none.
std::optional<OpticsRecord> optics_record(const std::filesystem::path& data,
                                          std::string_view serial);

/// Returns the optics of that record.
std::optional<SensorOptics> optics_in_force(const std::filesystem::path& data,
                                            std::string_view serial);

/// JSON of a record, for files and the API: that of solved optics, with `source` and `at`.
nlohmann::json to_json(const OpticsRecord& record);

}  // namespace octurn
