#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "capture/calibration_turn.hpp"
#include "capture/rig.hpp"
#include "config.hpp"
#include "config/config_store.hpp"

namespace octurn {

/// Options of the sensor and the turntable.
struct RigArguments {
  bool simulate = false;
  bool laser = false;          ///< simulates a camera with line lasers, not a depth sensor
  std::string mesh_file = {};  ///< on the simulated platform; empty: the simulator's own object
  bool other_lens = false;     ///< the simulated camera's lens differs from the settings
  int late_pictures = 0;       ///< by which the simulated camera is late
  bool perfect = false;    ///< the simulated sensor has no error but noise; its configured pose is
                           ///< true
  std::uint32_t unit = 1;  ///< whose optics the simulated sensor has, unless it is perfect
  std::optional<double> wall = {};        ///< metres from the simulated sensor to a wall it faces
  double speed = 1.0;                     ///< of the simulated rig, relative to real time
  std::optional<double> gear_ratio = {};  ///< of the simulated turntable; nothing: as configured
  bool reversed = false;                  ///< the simulated motor is wired the other way
  double play_deg = 0;                    ///< backlash of the simulated gears
  PlatformLoad load = {};                 ///< on the simulated turntable, if it has weight
  std::string sensor_uri = {};            ///< for `open_sensor`
};

/// The rig that the options select.
/// @param config  settings of the rig; a simulated turntable uses its gear_ratio and reversed
RigOptions rig_options(const RigArguments& arguments, const Config& config);

/// Options of the configuration.
struct ConfigArguments {
  std::optional<std::filesystem::path> file = {};
  nlohmann::json given = nlohmann::json::object();  ///< options by their keys in octurn.json
  std::optional<SensorKind> sensor = {};            ///< overrides the file's
};

/// Reads the configuration file. The page's settings override it, and the options of the command
/// line override both. If the page's settings cannot be used, `ConfigStore::trouble` says why.
/// @throws Error  that names the wrong key of the file or the options
ConfigStore open_config(const ConfigArguments& arguments);

/// The configuration in force with these options.
Config make_config(const ConfigArguments& arguments);

/// Checks before minutes of work that the model can be written. @param output  "-": standard output
/// @throws Error  that says why it cannot
void expect_writable(const std::filesystem::path& output);

struct ServeArguments {
  RigArguments rig = {};
  ConfigArguments config = {};
  std::optional<std::filesystem::path> web = {};
  std::optional<std::filesystem::path> appliance = {};  ///< folder of an Appliance
  std::string builds_by = "here";  ///< where models of stored scans are built: "here" or "slurm"
};

/// `octurn serve`: the daemon. Returns after SIGTERM or SIGINT.
void serve(const ServeArguments& arguments);

struct ScanArguments {
  RigArguments rig = {};
  ConfigArguments config = {};
  nlohmann::json settings = nlohmann::json::object();  ///< of ScanSettings, by their keys
  std::optional<std::string> resume = {};     ///< id of a scan to resume, with its own settings
  std::optional<std::string> pose_of = {};    ///< id or folder of the scan before turning it over
  std::filesystem::path output = "Scan.stl";  ///< "-" is standard output
  bool json = false;                          ///< one line of JSON on standard output
};

/// `octurn scan`: makes one scan. Writes the model to `output` and keeps the scan in `data`.
void scan(const ScanArguments& arguments);

struct RecordArguments {
  RigArguments rig = {};
  ConfigArguments config = {};
  std::filesystem::path output = {};
  std::filesystem::path wall = {};  ///< folder for frames of a wall, in place of a recording
  std::filesystem::path usb = {};   ///< file for what came over USB; empty: none
  int usb_seconds = 10;             ///< how long that is recorded
  int snapshots = 36;               ///< stops in a turn
  std::optional<int> frames = {};   ///< at each stop; default: 10, or 25 of a wall
};

/// `octurn record`: records the sensor during one turn of the platform, for `--sensor` to replay;
/// or frames of a wall, for `octurn calibrate --wall`; or what comes over USB, without turning.
void record(const RecordArguments& arguments);
void record_usb(const RecordArguments& arguments);
void record_wall(const RecordArguments& arguments);

struct DoctorArguments {
  RigArguments rig = {};
  ConfigArguments config = {};
  bool json = false;                              ///< one line of JSON in place of the table
  bool turn = false;                              ///< also turns the platform to check its motion
  std::optional<std::filesystem::path> zip = {};  ///< also writes an archive for remote support
};

/// `octurn doctor`: checks the scanner and says what to do about each fault. Moves the motor only
/// to measure a turn.
/// @return false if there is a fault
bool doctor(const DoctorArguments& arguments);

struct ReconstructArguments {
  std::filesystem::path folder = {};
  std::filesystem::path output = {};                     ///< "-" is standard output
  nlohmann::json settings = nlohmann::json::object();    ///< of ModelSettings, by their keys
  std::optional<std::filesystem::path> sensor_map = {};  ///< overrides the folder's
  bool json = false;                                     ///< one line of JSON on standard output
  bool colour = false;  ///< colours the model by the scan's pictures; its format is not STL
};

/// `octurn reconstruct`: makes a model from a scan folder.
void reconstruct(const ReconstructArguments& arguments);

struct CalibrateArguments {
  std::optional<std::filesystem::path> folder = {};      ///< a stored scan; nothing: turns the rig
  std::optional<std::filesystem::path> sensor_map = {};  ///< overrides the folder's
  bool apply = false;  ///< writes an accepted pose into the folder's scan.json
  bool json = false;   ///< one line of JSON in place of text
  RigArguments rig = {};
  ConfigArguments config = {};
  int stops = default_calibration_stops;  ///< of the turn
};

/// `octurn calibrate`: solves the sensor's pose from a stored scan or from a new turn of the
/// platform. An accepted pose of a turn is put into force.
/// @return false if the solution was rejected
bool calibrate(const CalibrateArguments& arguments);

struct CalibrateWallArguments {
  std::vector<std::filesystem::path> walls = {};  ///< folders with a wall.json
  std::filesystem::path output = {};
  bool json = false;  ///< one line of JSON in place of text
};

/// `octurn calibrate --wall`: maps a depth sensor's fixed pattern error from frames of flat walls.
/// @return false if the map was rejected
bool calibrate_wall(const CalibrateWallArguments& arguments);

struct CalibrateBoardArguments {
  std::filesystem::path folder = {};     ///< of pictures; empty: the rig's camera takes them
  std::optional<std::string> keep = {};  ///< serial number of the camera whose lens to store
  std::filesystem::path pdf = {};        ///< output of `print_board`
  std::string paper = "a4";              ///< paper size of the PDF
  std::optional<double> square_mm = {};  ///< side of the board's squares, as measured
  bool json = false;                     ///< one line of JSON in place of text
  RigArguments rig = {};
  ConfigArguments config = {};
};

/// `octurn calibrate --board`: solves the lens of a camera with lasers, from stored pictures of a
/// printed board or by the rig's camera; or the optics of the rig's depth sensor. What is accepted
/// of the rig is stored.
/// @return false if the solution was rejected
bool calibrate_board(const CalibrateBoardArguments& arguments);

/// `octurn calibrate --print-board`: writes the board as a PDF.
void print_board(const CalibrateBoardArguments& arguments);

struct SetArguments {
  std::filesystem::path file = {};
  std::vector<std::string> assignments = {};  ///< "turntable.gear_ratio=4"
};

/// `octurn set`: sets keys of a file such as octurn.json, all of them or none.
/// @throws Error  that names the wrong key
void set(const SetArguments& arguments);

struct MergeArguments {
  std::vector<std::filesystem::path> folders = {};
  std::filesystem::path output = {};  ///< folder, which must not exist yet
  bool json = false;                  ///< one line of JSON in place of text
  /// Index of the last scan's candidate pose to use, 0 is the best; nothing: registration chooses.
  std::optional<int> candidate = {};
  /// Point correspondences, millimetres: x, y, z in the first scan's frame, then in the last one's.
  std::vector<double> pairs = {};
};

/// `octurn merge`: registers several scans of one object in different poses and writes them as one
/// scan folder.
/// @return false if the scans do not fit together, or fit in several ways
bool merge(const MergeArguments& arguments);

/// `octurn password`: reads a line from standard input, and writes it as a password file for
/// `password_file` of the configuration.
void set_password(const std::filesystem::path& file);

struct UpdateArguments {
  std::filesystem::path file = {};
  bool takes_older = false;  ///< allows a version older than the one that runs
};

/// `octurn update`: replaces this process by the appliance's installer of updates (execv(3)).
/// @throws Error  if this is no appliance, or not root
[[noreturn]] void install_update(const UpdateArguments& arguments);

/// Parses the command line and runs the command.
/// @return the exit status: 0 for success, 1 for a failure, 2 for bad usage. One line on standard
///         error explains a failure.
int run(int argc, char** argv);

}  // namespace octurn
