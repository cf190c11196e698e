#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "file_descriptor.hpp"
#include "scan/build_run.hpp"
#include "scan/data_folder.hpp"
#include "scan/job.hpp"
#include "scan/scan_bin.hpp"
#include "scan/scan_id.hpp"
#include "scan/scan_label.hpp"

namespace octurn {

/// The scans on the disk: `DATA/scans/<id>/` with a scan folder, `Scan.stl`, `job.json` (what was
/// asked for and what became of it), `name.txt` and `notes.txt` (what a person wrote on it), and
/// `builds/<number>/` with the models that were built from it later. And `DATA/platform.json`,
/// which tells where the platform stands.
///
/// The files are read once, at the beginning, and then held: what is listed needs no disk. Each
/// file appears whole or not at all. Any thread may call anything at any time.
class ScanStore {
 public:
  /// Takes hold of the folder, clears away what a dead process left unfinished, and takes the scans
  /// that it was making as interrupted, also where that cannot be written down.
  /// @throws Error "data-in-use" if another process holds it; if it cannot be made or read
  explicit ScanStore(std::filesystem::path data);

  /// Makes the folder of a new scan, in state running. Its id comes after every other's, even where
  /// the clock has gone back.
  /// @throws Error "disk-full" if a scan of that many snapshots may not fit
  /// @param pose_of  of a scan of another pose
  Job create(const ScanSettings& settings, const std::optional<PoseOf>& pose_of = {});

  /// Writes `job.json`. Where that fails, the scan is what it was.
  /// @throws Error "no-such-scan", "disk-full", "write-failed"
  void save(const Job& job);

  /// Takes a scan as interrupted whose end could not be saved: what the next start would make of
  /// what is on the disk.
  /// @throws Error "no-such-scan"
  Job interrupt(std::string_view id);

  /// All scans, newest first. One whose `job.json` could not be read is listed as failed.
  std::vector<Job> list() const;
  std::optional<Job> find(std::string_view id) const;
  /// @throws Error "no-such-scan"
  Job get(std::string_view id) const;

  /// The scans of other poses of that scan, the oldest first.
  std::vector<Job> poses(std::string_view id) const;

  /// The id of the scan that was begun last, whatever has become of it; empty if there is none.
  std::string newest_id() const;

  /// The newest finished scan that is no other pose of one, if there is one.
  std::optional<Job> newest_finished() const;

  /// @throws Error "no-such-scan"
  void label(std::string_view id, const LabelChange& change);

  /// Removes a scan for good.
  void remove(std::string_view id);

  /// The scans that were deleted, and can be restored for some days, unless their space is needed.
  const ScanBin& bin() const { return bin_; }

  /// Moves a scan into the bin, with the scans of its object in other poses.
  /// @throws Error "no-such-scan", "data-failed", "disk-full"
  void discard(std::string_view id);

  /// Brings a scan back that is in the bin, with those of other poses.
  /// @throws Error "no-such-scan", "data-failed"
  void restore(std::string_view id);

  /// Removes what is in the bin for good.
  void empty_bin();

  /// Empties the bin, what was deleted first going first, until so much is free.
  /// @param what  is to be written, such as "a model"
  /// @throws Error "disk-full"  if it is empty and that may still not fit
  void make_room(std::uint64_t needed, const std::string& what);

  /// Makes a folder for a scan that comes from another Octurn, which the next start clears away.
  /// @throws Error "data-failed", "disk-full"
  std::filesystem::path begin_import();

  /// Takes a whole scan folder in that `begin_import` has made: a scan that waits for its model.
  /// @throws Error  if it cannot be read, "disk-full", "write-failed"
  Job adopt(const std::filesystem::path& beginning);

  /// Makes the folder of a build to come, which the next start clears away if it stays unfinished.
  /// @return where its `Scan.stl` belongs
  /// @throws Error "no-such-scan", "disk-full"  if a model may not fit, "data-failed"
  std::filesystem::path begin_build(std::string_view id, int number);

  /// The number that the next build of a scan has. @throws Error "no-such-scan"
  int next_build(std::string_view id) const;

  /// Keeps a build whose model is where `begin_build` has said. It appears whole or not at all.
  /// @throws Error "no-such-scan", "disk-full", "write-failed", "data-failed"
  void add_build(std::string_view id, const Build& build);

  /// Makes the folder of a build that another process makes, with the number that this has.
  /// @param run  whose number the build gets
  /// @return the folder, which is a build as soon as its `build.json` is there
  /// @throws Error "no-such-scan", "disk-full"  if a model may not fit, "data-failed"
  std::filesystem::path reserve_build(BuildRun& run);

  /// Takes in a build that another process has made in the folder that was reserved.
  /// @throws Error "no-such-scan", "job-malformed", "read-failed"
  void take_build(std::string_view id, int number);

  /// Removes such a folder, whose build will not come.
  void release_build(std::string_view id, int number);

  /// Removes what a build has begun and will not finish.
  void drop_build(std::string_view id, int number);

  /// Makes the model of a build the scan's; that of build 0 is what the scan itself made.
  /// @throws Error "no-such-scan", "no-model"  if there is no such build, "disk-full",
  /// "write-failed"
  void choose_build(std::string_view id, int number);

  /// @throws Error "no-such-scan", "no-model"  if there is no such build, "busy"  if it is chosen
  void remove_build(std::string_view id, int number);

  /// The scan folder that builds with these other poses are made from: that of the build which
  /// merged them; without poses, the scan's own. @throws Error "no-model"  if there is none
  std::filesystem::path merged_scan(std::string_view id,
                                    const std::vector<std::string>& poses) const;

  /// Removes the builds that have the object in that pose. If one of them is chosen, the model is
  /// again what it was before. @throws  as `choose_build` and `remove_build`
  void withdraw_pose(std::string_view id, const std::string& pose);

  /// The data folder.
  const std::filesystem::path& data() const { return data_; }

  /// @param id  that exists
  std::filesystem::path folder(std::string_view id) const;
  /// The scan's model, which is that of the build that was chosen.
  std::filesystem::path model_file(std::string_view id) const;
  /// The model of a build; of build 0, what the scan itself made.
  std::filesystem::path model_file(std::string_view id, int build) const;

  /// Where the platform was when it was written down last, degrees; 0 if it never was.
  double platform_angle_deg() const;
  void save_platform_angle_deg(double angle_deg) const;

  std::uint64_t free_bytes() const;

  /// Another number after every scan that came, ended, was labelled, built again or removed: who
  /// has listed the scans at the same number need not do it again. Not the same in another process.
  std::uint64_t revision() const;

 private:
  ScanTime next_time() const;
  void enter(const std::filesystem::path& beginning, const Job& job);
  void recover();
  void finish_discards();
  void bring_back(const BinnedScan& scan);
  void take_away(const Job& job);
  void write_job(const Job& job) const;

  std::filesystem::path data_;
  std::filesystem::path scans_;
  std::filesystem::path platform_;
  FileDescriptor lock_;  // locked while it is open
  ScanBin bin_;
  std::mutex writing_;        // held by who writes a scan's files; taken before mutex_
  mutable std::mutex mutex_;  // guards what follows, and is never held while the disk is used
  std::map<std::string, Job, std::greater<>> jobs_;
  std::uint64_t revision_;
};

}  // namespace octurn
