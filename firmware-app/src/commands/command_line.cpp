#include <CLI/CLI.hpp>
#include <iostream>

#include "commands/commands.hpp"
#include "interruption.hpp"
#include "octurn/error.hpp"
#include "version.hpp"

namespace octurn {
namespace {

/// @return the option --simulate, whose presence alone says something
CLI::Option* add_rig_options(CLI::App& command, RigArguments& rig) {
  CLI::Option* simulate =
      command
          .add_option("--simulate", rig.mesh_file,
                      "scan with a simulated rig; MESH (STL, millimetres) stands on it")
          ->type_name("[=MESH]")
          ->expected(0, 1);
  command
      .add_option("--simulate-speed", rig.speed, "how much faster than life the simulated rig is")
      ->type_name("FACTOR")
      ->check(CLI::Range(0.1, 1000.0))
      ->needs(simulate);
  command
      .add_option("--sensor", rig.sensor_uri,
                  "use this as the sensor: kinect://, another OpenNI2 device, an .oni file, or a "
                  "folder of `octurn record`")
      ->type_name("URI");
  return simulate;
}

void add_config_option(CLI::App& command, std::optional<std::filesystem::path>& config_file) {
  command
      .add_option("--config", config_file,
                  std::string("settings (") + default_config_file + ", if it is there)")
      ->type_name("FILE");
}

void add_config_options(CLI::App& command, std::optional<std::filesystem::path>& config_file,
                        std::optional<std::filesystem::path>& data) {
  add_config_option(command, config_file);
  command.add_option("--data", data, "folder of the scans (/var/lib/octurn)")->type_name("DIR");
}

/// Options that `scan` and `reconstruct` share; both have members of these names.
template <typename Arguments>
void add_model_options(CLI::App& command, Arguments& arguments, const char* clip_default) {
  command.add_option("--leaf-size-mm", arguments.leaf_size_mm, "largest side of a leaf (1)")
      ->type_name("MM");
  command.add_option("--root-size-mm", arguments.root_size_mm, "side of the root cube (1000)")
      ->type_name("MM");
  command
      .add_option("--threshold-m2", arguments.threshold_m2,
                  "square of a triangle's longest side (0.0001)")
      ->type_name("M2");
  command
      .add_option("--clip-mm", arguments.clip_mm,
                  std::string("box around the object, platform frame (") + clip_default + ")")
      ->type_name("X0 Y0 Z0 X1 Y1 Z1");
}

/// The same for what chooses the method.
template <typename Arguments>
void add_method_options(CLI::App& command, Arguments& arguments, const std::string& usual) {
  command
      .add_option(
          "--method", arguments.method,
          "solid: one closed, filled, smooth part; intersection: a shell of what was seen (" +
              usual + ")")
      ->type_name("NAME")
      ->check(CLI::IsMember({"intersection", "solid"}));
  command
      .add_option("--max-error-mm", arguments.max_error_mm,
                  "solid: root mean square distance that fewer triangles may cost (0.04); "
                  "0 keeps them all")
      ->type_name("MM");
}

void add_serve(CLI::App& program, ServeArguments& arguments) {
  CLI::App& command = *program.add_subcommand("serve", "the daemon: page, API, scans");
  const CLI::Option* simulate = add_rig_options(command, arguments.rig);
  add_config_options(command, arguments.config_file, arguments.data);
  command.add_option("--listen", arguments.address, "address to listen on (0.0.0.0, which is all)")
      ->type_name("ADDRESS");
  command.add_option("--port", arguments.port, "port of the page (8080); 0 is any free one")
      ->type_name("N")
      ->check(CLI::Range(0, 65535));
  command.add_option("--web", arguments.web, "folder of the page (the one built or installed)")
      ->type_name("DIR");
  command
      .add_option("--appliance", arguments.appliance,
                  "this machine is Octurn's image: folder through which the page has updates and "
                  "WiFi done")
      ->type_name("DIR");
  command.callback([&arguments, simulate] {
    arguments.rig.simulate = simulate->count() > 0;
    serve(arguments);
  });
}

void add_scan(CLI::App& program, ScanArguments& arguments) {
  CLI::App& command = *program.add_subcommand("scan", "one scan from the shell");
  SettingsArguments& settings = arguments.settings;
  const CLI::Option* simulate = add_rig_options(command, arguments.rig);
  add_config_options(command, arguments.config_file, arguments.data);
  command.add_option("-o,--output", arguments.output, "the model (Scan.stl)")->type_name("FILE");
  command.add_option("--snapshots", settings.snapshots, "stops in a turn (36)")->type_name("N");
  command
      .add_option("--filter", settings.filter,
                  "how frames become one: basic, average or average-discard (average)")
      ->type_name("NAME");
  command.add_option("--frames", settings.frames, "frames at each stop (10)")->type_name("N");
  add_method_options(command, settings, "solid");
  add_model_options(command, settings, "-140 -140 5 140 140 400");
  command
      .add_option("--resume", arguments.resume,
                  "go on with this scan in the folder of scans, which was paused or interrupted; "
                  "its own settings apply")
      ->type_name("ID");
  command.callback([&arguments, simulate] {
    arguments.rig.simulate = simulate->count() > 0;
    scan(arguments);
  });
}

void add_record(CLI::App& program, RecordArguments& arguments) {
  CLI::App& command = *program.add_subcommand(
      "record", "what the sensor sees in a turn, to be replayed by --sensor");
  const CLI::Option* simulate = add_rig_options(command, arguments.rig);
  add_config_option(command, arguments.config_file);
  command
      .add_option("-o,--output", arguments.output,
                  "folder for the recording, which must not exist yet")
      ->type_name("DIR")
      ->required();
  command.add_option("--snapshots", arguments.snapshots, "stops in a turn (36); 1 does not turn")
      ->type_name("N")
      ->check(CLI::Range(1, 200));
  command.add_option("--frames", arguments.frames, "frames at each stop (10)")
      ->type_name("N")
      ->check(CLI::Range(1, 100'000));
  command.callback([&arguments, simulate] {
    arguments.rig.simulate = simulate->count() > 0;
    record(arguments);
  });
}

void add_doctor(CLI::App& program, DoctorArguments& arguments, int& status) {
  CLI::App& command =
      *program.add_subcommand("doctor", "checks the scanner, and says what to do about each fault");
  const CLI::Option* simulate = add_rig_options(command, arguments.rig);
  add_config_options(command, arguments.config_file, arguments.data);
  command.add_flag("--json", arguments.json, "print one line of JSON in place of the table");
  command
      .add_option("--zip", arguments.zip,
                  "also write versions, settings, findings and the system's state to this file, to "
                  "be sent to who helps")
      ->type_name("FILE");
  command.footer(
      "It never moves the motor. It ends with 0 if there is no fault, with 1 if one is.");
  command.callback([&arguments, &status, simulate] {
    arguments.rig.simulate = simulate->count() > 0;
    status = doctor(arguments) ? 0 : 1;
  });
}

void add_reconstruct(CLI::App& program, ReconstructArguments& arguments) {
  CLI::App& command = *program.add_subcommand("reconstruct", "a model from a scan folder");
  command.add_option("SCAN_DIR", arguments.folder, "folder with a scan.json")->required();
  command
      .add_option("-o,--output", arguments.output,
                  "the model, binary STL in millimetres; - is standard output")
      ->type_name("FILE")
      ->required();
  add_method_options(command, arguments, "intersection");
  add_model_options(command, arguments, "the scan's");
  command.add_option("--level", arguments.level, "surface of a coarser level; 0 is the root")
      ->type_name("N");
  command.add_option("--threads", arguments.threads, "threads to work on (all cores)")
      ->type_name("N")
      ->check(CLI::Range(1, 256));
  command
      .add_option("--memory-limit-mb", arguments.memory_limit_mb,
                  "memory that the program may take (no limit); less of it takes longer")
      ->type_name("MB")
      ->check(CLI::PositiveNumber);
  command.add_flag("--json", arguments.json,
                   "print one line of JSON on standard output, or on standard error with -o -");
  command.callback([&] { reconstruct(arguments); });
}

void add_password(CLI::App& program, std::filesystem::path& file) {
  CLI::App& command = *program.add_subcommand("password", "gives the page a password");
  command
      .add_option("FILE", file,
                  "what it is kept in, for password_file of octurn.json; made if it is not there")
      ->required();
  command.footer("Reads the password from standard input, a line. The user is octurn.");
  command.callback([&file] { set_password(file); });
}

void add_update(CLI::App& program, std::filesystem::path& file) {
  CLI::App& command =
      *program.add_subcommand("update", "installs an update of the appliance's image, as root");
  command.add_option("FILE", file, "octurn.update, as image-build makes it")->required();
  command.footer("The page does the same. The scanner then starts again.");
  command.callback([&file] { install_update(file); });
}

int fail(const std::string& message, const std::string& hint, int status) {
  std::cerr << "octurn: " << message << (hint.empty() ? "" : " (" + hint + ")") << '\n';
  return status;
}

}  // namespace

int run(int argc, char** argv) {
  CLI::App program("Octurn: a 3D scanner appliance. Turns an object, looks at it, prints a model.",
                   "octurn");
  program.set_version_flag("--version", "octurn " + std::string(version()));
  program.require_subcommand(1);
  ServeArguments serve_arguments;
  ScanArguments scan_arguments;
  RecordArguments record_arguments;
  DoctorArguments doctor_arguments;
  ReconstructArguments reconstruct_arguments;
  std::filesystem::path password_file;
  std::filesystem::path update_file;
  int status = 0;
  add_serve(program, serve_arguments);
  add_scan(program, scan_arguments);
  add_record(program, record_arguments);
  add_doctor(program, doctor_arguments, status);
  add_reconstruct(program, reconstruct_arguments);
  add_password(program, password_file);
  add_update(program, update_file);

  block_signals();
  try {
    program.parse(argc, argv);  // and runs the command
    return status;
  } catch (const CLI::ParseError& error) {
    return program.exit(error) == 0 ? 0 : 2;
  } catch (const Error& error) {
    return fail(error.what(), error.hint(), error.code() == "bad-settings" ? 2 : 1);
  } catch (const std::exception& error) {
    return fail(error.what(), "", 1);
  }
}

}  // namespace octurn
