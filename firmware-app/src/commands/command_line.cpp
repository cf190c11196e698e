#include <CLI/CLI.hpp>
#include <iostream>

#include "commands/calibrate_options.hpp"
#include "commands/commands.hpp"
#include "commands/model_commands.hpp"
#include "commands/options.hpp"
#include "octurn/error.hpp"
#include "rig/usb_log.hpp"
#include "settings/scan_settings.hpp"
#include "signal_stop.hpp"
#include "version.hpp"

namespace octurn {
namespace {

void add_serve(CLI::App& program, ServeArguments& arguments) {
  CLI::App& command = *program.add_subcommand("serve", "the daemon: page, API, scans");
  add_rig_options(command, arguments.rig, arguments.config);
  add_config_options(command, arguments.config);
  Config defaults;
  add_options(command, network_fields(defaults), arguments.config.given);
  command.add_option("--web", arguments.web, "folder of the page (the one built or installed)")
      ->type_name("DIR");
  command
      .add_option("--appliance", arguments.appliance,
                  "this machine runs Octurn's image: folder through which the page asks the system "
                  "for updates and WiFi")
      ->type_name("DIR");
  command
      .add_option("--builds-by", arguments.builds_by,
                  "who builds models of stored scans, also of those that are uploaded: slurm "
                  "submits each as a job with sbatch, for which the folder of scans has to be on a "
                  "disk that its machines share; here is this process (here)")
      ->type_name("here|slurm")
      ->check(CLI::IsMember({"here", "slurm"}));
  command.callback([&arguments] { serve(arguments); });
}

void add_scan(CLI::App& program, ScanArguments& arguments) {
  CLI::App& command = *program.add_subcommand("scan", "one scan from the shell");
  add_rig_options(command, arguments.rig, arguments.config);
  add_config_options(command, arguments.config);
  command.add_option("-o,--output", arguments.output, "the model (Scan.stl); - is standard output")
      ->type_name("FILE");
  ScanSettings defaults;
  add_options(command, scan_fields(defaults), arguments.settings);
  CLI::Option* resume =
      command
          .add_option("--resume", arguments.resume,
                      "go on with this scan in the folder of scans, which was paused or "
                      "interrupted; its own settings apply")
          ->type_name("ID");
  command
      .add_option("--pose-of", arguments.pose_of,
                  "the object of this scan in the folder of scans, turned over: make one model of "
                  "both, which is kept with that scan; its settings apply where none are given. A "
                  "scan folder elsewhere is left as it is: scan, then octurn merge both")
      ->type_name("ID|DIR")
      ->excludes(resume);
  command.add_flag("--json", arguments.json,
                   "print the scan, as the HTTP interface has it, as one line of JSON on standard "
                   "output, or on standard error with -o -");
  command.callback([&arguments] { scan(arguments); });
}

void add_record(CLI::App& program, RecordArguments& arguments) {
  CLI::App& command = *program.add_subcommand(
      "record", "records the sensor's frames of a turn, to be replayed by --sensor");
  add_rig_options(command, arguments.rig, arguments.config);
  add_config_option(command, arguments.config);
  CLI::Option* output = command
                            .add_option("-o,--output", arguments.output,
                                        "folder for the recording, which must not exist yet")
                            ->type_name("DIR");
  CLI::Option* wall =
      command
          .add_option("--wall", arguments.wall,
                      "record what it sees of a bare wall instead, for `octurn calibrate --wall`: "
                      "folder for it, which must not exist yet")
          ->type_name("WALL_DIR")
          ->excludes(output);
  CLI::Option* usb =
      command
          .add_option("--usb", arguments.usb,
                      "file for what comes over USB: times, lengths, headers and losses of a "
                      "Kinect's packets, without the depth in them; with --output those of the "
                      "turn")
          ->type_name("FILE")
          ->excludes(wall);
  command.add_option("--usb-seconds", arguments.usb_seconds, "how long --usb records (10)")
      ->type_name("N")
      ->check(CLI::Range(1, max_usb_log_seconds))
      ->needs(usb);
  command.add_option("--snapshots", arguments.snapshots, "stops in a turn (36); 1 does not turn")
      ->type_name("N")
      ->check(CLI::Range(1, requested_ranges.max_snapshots))
      ->excludes(wall);
  command.add_option("--frames", arguments.frames, "frames at each stop (10), or of a wall (25)")
      ->type_name("N")
      ->check(CLI::Range(1, 100'000));
  command.callback([&arguments, output, wall, usb] {
    if (output->count() + wall->count() + usb->count() == 0) {
      throw CLI::RequiredError("--output, --wall or --usb");
    }
    record(arguments);
  });
}

void add_doctor(CLI::App& program, DoctorArguments& arguments, int& status) {
  CLI::App& command =
      *program.add_subcommand("doctor", "checks the scanner, and says what to do about each fault");
  add_rig_options(command, arguments.rig, arguments.config);
  add_config_options(command, arguments.config);
  command.add_flag("--json", arguments.json, "print one line of JSON in place of the table");
  command.add_flag("--turn", arguments.turn,
                   "also turn the platform with an object on it, and see how it moves");
  command
      .add_option("--zip", arguments.zip,
                  "also write versions, settings, findings and the system's state to this file, to "
                  "be sent to somebody who helps")
      ->type_name("FILE");
  command.footer(
      "Without --turn it never moves the motor. It ends with 0 if there is no fault, with 1 if one "
      "is.");
  command.callback([&arguments, &status] { status = doctor(arguments) ? 0 : 1; });
}

void add_set(CLI::App& program, SetArguments& arguments) {
  CLI::App& command =
      *program.add_subcommand("set", "sets keys of octurn.json, or of a file like it");
  command.add_option("FILE", arguments.file, "made if it is not there")->required();
  command
      .add_option("SETTING", arguments.assignments,
                  "KEY=VALUE, such as port=80 or turntable.gear_ratio=4")
      ->required();
  command.footer("If a setting is wrong, it is named and none is set.");
  command.callback([&arguments] { set(arguments); });
}

void add_merge(CLI::App& program, MergeArguments& arguments, int& status) {
  CLI::App& command = *program.add_subcommand(
      "merge", "one scan of an object that was scanned, turned over, and scanned again");
  command.add_option("SCAN_DIR", arguments.folders, "folders with a scan.json each")->required();
  command.add_option("-o,--output", arguments.output, "scan folder to write; must not exist yet")
      ->type_name("SCAN_DIR")
      ->required();
  command.add_flag("--json", arguments.json, "print one line of JSON in place of text");
  auto* const candidate =
      command.add_option("--candidate", arguments.candidate,
                         "take this of the poses that --json lists; 0 is the best");
  command
      .add_option(
          "--pairs", arguments.pairs,
          "three or more points of the object, mm: X Y Z in the first scan, in the last one")
      ->excludes(candidate);
  command.footer(
      "It ends with 0 if the scans fit together, with 1 and the reason if they do not, or in "
      "several ways that give different shapes.");
  command.callback([&arguments, &status] { status = merge(arguments) ? 0 : 1; });
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

void add_update(CLI::App& program, UpdateArguments& arguments) {
  CLI::App& command =
      *program.add_subcommand("update", "installs an update of the appliance's image, as root");
  command.add_flag("--older", arguments.takes_older,
                   "also if it is older than the version that runs");
  command.add_option("FILE", arguments.file, "octurn.update, as image-build makes it")->required();
  command.footer("The page does the same. The scanner then starts again.");
  command.callback([&arguments] { install_update(arguments); });
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
  TileArguments reconstruct_arguments;
  JoinArguments join_arguments;
  std::filesystem::path build_folder;
  ImportArguments import_arguments;
  CalibrateOptions calibrate_options;
  SetArguments set_arguments;
  MergeArguments merge_arguments;
  std::filesystem::path password_file;
  UpdateArguments update;
  int status = 0;
  add_serve(program, serve_arguments);
  add_scan(program, scan_arguments);
  add_record(program, record_arguments);
  add_doctor(program, doctor_arguments, status);
  add_reconstruct(program, reconstruct_arguments);
  add_join(program, join_arguments);
  add_build(program, build_folder);
  add_import(program, import_arguments);
  add_calibrate(program, calibrate_options, status);
  add_set(program, set_arguments);
  add_merge(program, merge_arguments, status);
  add_password(program, password_file);
  add_update(program, update);

  block_signals();
  const auto is_first_word = [&](const CLI::App* command) {
    return command->get_name() == argv[1];
  };
  if (argc > 1 && argv[1][0] != '-' && program.get_subcommands(is_first_word).empty()) {
    return fail("\"" + std::string(argv[1]) + "\" is no command", "octurn --help lists them", 2);
  }
  try {
    program.parse(argc, argv);  // and runs the command
    return status;
  } catch (const CLI::ParseError& error) {
    return program.exit(error) == 0 ? 0 : 2;
  } catch (const Error& error) {
    return fail(error.what(), error.hint(), error.code() == ErrorCode::bad_settings ? 2 : 1);
  } catch (const std::exception& error) {
    return fail(error.what(), "", 1);
  }
}

}  // namespace octurn
