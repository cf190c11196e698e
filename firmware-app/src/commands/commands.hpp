#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "config.hpp"
#include "config/config_store.hpp"
#include "scan/calibration_turn.hpp"
#include "scan/rig.hpp"

namespace octurn {

/// Options of the sensor and the turntable.
struct RigArguments {
  bool simulate = false;
  bool laser = false;          ///< what is simulated is a camera with line lasers
  std::string mesh_file = {};  ///< on the simulated platform; empty: the simulator's own object
  bool other_lens = false;     ///< the simulated camera's lens is not the one of the settings
  bool perfect = false;  ///< the simulated sensor has no error of its own, and its pose is true
  std::optional<double> wall = {};        ///< metres: the simulated sensor looks at a wall
  double speed = 1.0;                     ///< of the simulated rig, relative to life
  std::optional<double> gear_ratio = {};  ///< of the simulated turntable; none: as it is set
  bool reversed = false;                  ///< the simulated motor is wired the other way
  double play_deg = 0;                    ///< of the simulated gears
  std::string sensor_uri = {};            ///< of a DepthSensor; empty: the default one
};

/// The rig that the options select.
/// @param config  what it is told of itself. A simulated turntable obeys gear_ratio and reversed
RigOptions rig_options(const RigArguments& arguments, const Config& config);

/// Options of the configuration.
struct ConfigArguments {
  std::optional<std::filesystem::path> file = {};
  nlohmann::json given = nlohmann::json::object();  ///< by their keys in octurn.json
  std::optional<SensorKind> sensor = {};            ///< in place of the file's
};

/// The configuration file, the page's settings over it, and the options of the command line over
/// both. Warns of page's settings that cannot be used.
/// @throws Error  that names the wrong key of the file or the options
ConfigStore open_config(const ConfigArguments& arguments);

/// What is in force with these.
Config make_config(const ConfigArguments& arguments);

/// Checks before minutes of work that the model can be written. @param output  "-": standard output
/// @throws Error  that says why it cannot
void expect_writable(const std::filesystem::path& output);

struct ServeArguments {
  RigArguments rig = {};
  ConfigArguments config = {};
  std::optional<std::filesystem::path> web = {};
  std::optional<std::filesystem::path> appliance = {};  ///< folder of an Appliance
  std::string builds_by = "here";                       ///< or "slurm": who builds stored scans
};

/// `octurn serve`: the daemon. Returns after SIGTERM or SIGINT.
void serve(const ServeArguments& arguments);

struct ScanArguments {
  RigArguments rig = {};
  ConfigArguments config = {};
  nlohmann::json settings = nlohmann::json::object();  ///< of ScanSettings, by their keys
  std::optional<std::string> resume = {};     ///< id of a scan to resume, with its own settings
  std::optional<std::string> pose_of = {};    ///< id or folder of a scan of the object, turned over
  std::filesystem::path output = "Scan.stl";  ///< "-" is standard output
};

/// `octurn scan`: makes one scan. Writes the model to `output` and keeps the scan in `data`.
void scan(const ScanArguments& arguments);

struct RecordArguments {
  RigArguments rig = {};
  ConfigArguments config = {};
  std::filesystem::path output = {};
  std::filesystem::path wall = {};  ///< folder for a look at a wall, in place of a recording
  int snapshots = 36;               ///< stops in a turn
  std::optional<int> frames = {};   ///< at each stop; 10, or 25 of a wall
};

/// `octurn record`: records the sensor during one turn of the platform, for `--sensor` to replay;
/// or what it sees of a wall, for `octurn calibrate --wall`.
void record(const RecordArguments& arguments);
void record_wall(const RecordArguments& arguments);

struct DoctorArguments {
  RigArguments rig = {};
  ConfigArguments config = {};
  bool json = false;                              ///< one line of JSON in place of the table
  bool turn = false;                              ///< also turns the platform, and looks
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
  std::optional<std::filesystem::path> sensor_map = {};  ///< in place of the folder's
  bool json = false;                                     ///< one line of JSON on standard output
  bool colour = false;  ///< the model is no STL, and has the colours of the scan's pictures
};

/// `octurn reconstruct`: makes a model from a scan folder.
void reconstruct(const ReconstructArguments& arguments);

struct CalibrateArguments {
  std::optional<std::filesystem::path> folder = {};      ///< a stored scan; none: a turn on the rig
  std::optional<std::filesystem::path> sensor_map = {};  ///< in place of the folder's
  bool apply = false;  ///< writes what is accepted into the folder's scan.json
  bool json = false;   ///< one line of JSON in place of text
  RigArguments rig = {};
  ConfigArguments config = {};
  int stops = default_calibration_stops;  ///< of the turn
};

/// `octurn calibrate`: the sensor's pose, from a stored scan, or from a turn that is made for it. A
/// pose that a turn tells is in force from then on.
/// @return false if what was solved is not to be trusted
bool calibrate(const CalibrateArguments& arguments);

struct CalibrateWallArguments {
  std::vector<std::filesystem::path> walls = {};  ///< folders with a wall.json
  std::filesystem::path output = {};
  bool json = false;  ///< one line of JSON in place of text
};

/// `octurn calibrate --wall`: the map of a sensor's own error, from looks at flat walls.
/// @return false if they are no walls
bool calibrate_wall(const CalibrateWallArguments& arguments);

struct CalibrateBoardArguments {
  std::filesystem::path folder = {};     ///< of pictures; empty: the rig's camera looks at it
  std::optional<std::string> keep = {};  ///< serial number of the camera that took them
  std::filesystem::path pdf = {};        ///< for `print_board`
  std::string paper = "a4";              ///< of that
  bool json = false;                     ///< one line of JSON in place of text
  RigArguments rig = {};
  ConfigArguments config = {};
};

/// `octurn calibrate --board`: the lens of a camera with lasers, from pictures of a printed board
/// or from such a board that is held before the camera. The latter is kept if it is accepted.
/// @return false if what was solved is not to be trusted
bool calibrate_board(const CalibrateBoardArguments& arguments);

/// `octurn calibrate --print-board`: writes that board as a PDF.
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
  /// Of the poses that fit the last scan, the one to take, the best 0; none: what is accepted.
  std::optional<int> candidate = {};
  /// Or points of the object: x, y, z in the first scan's frame, then in the last one's; mm.
  std::vector<double> pairs = {};
};

/// `octurn merge`: one scan folder of several scans of one object, laid down in several ways.
/// @return false if the scans do not fit together, or in several ways
bool merge(const MergeArguments& arguments);

/// `octurn password`: reads a line from standard input, and writes it as a password file for
/// `password_file` of the configuration.
void set_password(const std::filesystem::path& file);

/// What `octurn update` installs.
struct UpdateArguments {
  std::filesystem::path file = {};
  bool takes_older = false;  ///< also a version that is older than the one that runs
};

/// `octurn update`: executes the appliance's program that installs an update, in this process.
/// @throws Error  if this is no appliance, or not root
[[noreturn]] void install_update(const UpdateArguments& arguments);

/// Parses the command line and runs the command.
/// @return the exit status: 0 for success, 1 for a failure, 2 for bad usage. One line on standard
///         error explains a failure.
int run(int argc, char** argv);

}  // namespace octurn
