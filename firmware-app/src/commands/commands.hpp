#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>

#include "config.hpp"
#include "scan/rig.hpp"

namespace octurn {

/// What a command line says about sensor and turntable.
struct RigArguments {
  bool simulate = false;
  std::string mesh_file = {};   ///< on the simulated platform; empty: the simulator's own object
  double speed = 1.0;           ///< of the simulated rig, relative to life
  std::string sensor_uri = {};  ///< of a DepthSensor, in place of the simulated one
};

/// @param stepper  of the real turntable, which is used without --simulate
RigOptions rig_options(const RigArguments& arguments, const StepperSettings& stepper);

struct ServeArguments {
  RigArguments rig = {};
  std::optional<std::filesystem::path> config_file = {};
  std::optional<std::string> address = {};
  std::optional<int> port = {};
  std::optional<std::filesystem::path> data = {};
  std::optional<std::filesystem::path> web = {};
  std::optional<std::filesystem::path> appliance = {};  ///< folder of an Appliance
};

/// `octurn serve`: the daemon. Returns after SIGTERM or SIGINT.
void serve(const ServeArguments& arguments);

/// What a command line says about a scan, in the units of its options.
struct SettingsArguments {
  std::optional<std::string> method = {};
  std::optional<double> max_error_mm = {};
  std::optional<int> snapshots = {};
  std::optional<std::string> filter = {};
  std::optional<int> frames = {};
  std::optional<double> leaf_size_mm = {};
  std::optional<double> threshold_m2 = {};
  std::optional<double> root_size_mm = {};
  std::optional<std::array<double, 6>> clip_mm = {};
};

struct ScanArguments {
  RigArguments rig = {};
  SettingsArguments settings = {};
  std::optional<std::string> resume = {};  ///< the scan to go on with, by its own settings
  std::optional<std::filesystem::path> config_file = {};
  std::optional<std::filesystem::path> data = {};
  std::filesystem::path output = "Scan.stl";
};

/// `octurn scan`: one scan from the shell. The model goes to `output`, the scan stays in `data`.
void scan(const ScanArguments& arguments);

struct RecordArguments {
  RigArguments rig = {};
  std::optional<std::filesystem::path> config_file = {};
  std::filesystem::path output = {};
  int snapshots = 36;  ///< stops in a turn
  int frames = 10;     ///< at each stop
};

/// `octurn record`: what the sensor sees in a turn of the platform, to be replayed as the sensor.
void record(const RecordArguments& arguments);

struct DoctorArguments {
  RigArguments rig = {};
  std::optional<std::filesystem::path> config_file = {};
  std::optional<std::filesystem::path> data = {};
  bool json = false;                              ///< one line of JSON in place of the table
  std::optional<std::filesystem::path> zip = {};  ///< also an archive for who helps from afar
};

/// `octurn doctor`: checks the scanner and says what to do about each fault. Never moves the motor.
/// @return false if there is a fault
bool doctor(const DoctorArguments& arguments);

struct ReconstructArguments {
  std::filesystem::path folder = {};
  std::filesystem::path output = {};  ///< "-" is standard output
  std::string method = "intersection";
  std::optional<double> max_error_mm = {};
  std::optional<double> leaf_size_mm = {};
  std::optional<double> root_size_mm = {};
  std::optional<double> threshold_m2 = {};
  std::optional<std::array<double, 6>> clip_mm = {};  ///< default: the scan's
  std::optional<int> level = {};
  std::optional<int> threads = {};             ///< default: all cores
  std::optional<double> memory_limit_mb = {};  ///< of the whole process; default: none
  bool json = false;                           ///< one line of JSON on standard output
};

/// `octurn reconstruct`: a model from a scan folder.
void reconstruct(const ReconstructArguments& arguments);

/// `octurn password`: reads a password, a line, from standard input, and writes the file that
/// `password_file` of the configuration names.
void set_password(const std::filesystem::path& file);

/// `octurn update`: becomes the appliance's own program that installs an update.
/// @throws Error  if this is no appliance, or not root
[[noreturn]] void install_update(const std::filesystem::path& file);

/// Reads the command line and does what it says.
/// @return the exit status: 0, 1 if it failed, which one line on standard error explains, 2 for bad
///         usage
int run(int argc, char** argv);

}  // namespace octurn
