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
#include "store/builds.hpp"
#include "store/data_folder.hpp"
#include "store/job.hpp"
#include "store/scan_bin.hpp"
#include "wall_clock.hpp"

namespace octurn {

/// The scans on the disk: `DATA/scans/<id>/` with a scan folder, `Scan.stl`, `job.json` (settings,
/// state and results), the texts of its label such as `name.txt`, and `builds/<number>/` with
/// models that were built later. Also `DATA/platform.json` with the platform's angle.
///
/// The files are read once, by the constructor, and then held in memory: listing scans needs no
/// disk. Each file appears whole or not at all. Thread-safe.
class ScanStore {
 public:
  /// Locks the folder, removes unfinished files of a dead process, and marks the scans that it was
  /// making as interrupted, even if that cannot be written.
  /// @throws Error "data-in-use" if another process holds it; if it cannot be made or read
  explicit ScanStore(std::filesystem::path data, WallClock clock = {});

  /// Makes the folder of a new scan, in state running. Its id sorts after all others, even if the
  /// clock was set back.
  /// @throws Error "disk-full" if a scan of that many snapshots may not fit
  /// @param pose_of  the link of a scan of another pose
  Job create(const ScanSettings& settings, const std::optional<PoseOf>& pose_of = {},
             const LabelChange& label = {});

  /// Writes `job.json` with the progress or the outcome of a scan that runs. Its label and its
  /// builds stay as stored: they may have changed since `job` was copied. If writing fails, the
  /// scan in memory does not change.
  /// @throws Error "no-such-scan", "disk-full", "write-failed"
  void save(const Job& job);

  /// Changes a stored scan, with no other change between reading and writing it.
  /// @param change  of anything but the label; must not write to this store. If it throws, nothing
  ///                changes.
  /// @return the changed scan
  /// @throws Error  as `save`, and what `change` throws
  Job update(std::string_view id, const std::function<void(Job&)>& change);

  /// Marks a scan whose outcome could not be saved as interrupted, as the next start would.
  /// @param reason  for display, until the next start
  /// @throws Error "no-such-scan"
  Job interrupt(std::string_view id, const Failure& reason);

  /// Lists all scans, newest first. One whose `job.json` could not be read is listed as failed.
  std::vector<Job> list() const;
  std::optional<Job> find(std::string_view id) const;
  /// @throws Error "no-such-scan"
  Job get(std::string_view id) const;

  /// Lists the scans of other poses of that scan, oldest first.
  std::vector<Job> poses(std::string_view id) const;

  /// Returns the id of the scan that was begun last, including those in the bin; empty if there is
  /// none.
  std::string newest_id() const;

  /// Returns the newest finished scan that is not a scan of another pose.
  std::optional<Job> newest_finished() const;

  /// @throws Error "no-such-scan"
  void label(std::string_view id, const LabelChange& change);

  /// The deleted scans, which can be restored for some days, unless their space is needed.
  const ScanBin& bin() const { return bin_; }

  /// Moves a scan into the bin, with the scans of its object in other poses.
  /// @throws Error "no-such-scan", "data-failed", "disk-full"
  void discard(std::string_view id);

  /// Moves a scan of another pose into the bin, with the builds that merge it. If one of them is
  /// chosen, the model chosen before it is restored.
  /// @param id  of a scan whose first scan exists
  /// @throws Error "no-such-scan", "data-failed", "disk-full", "write-failed"
  void discard_pose(const std::string& id);

  /// Moves a scan out of the bin, with the scans of other poses that were deleted with it. A pose
  /// that was removed from its scan joins it again, with their model, which is chosen unless
  /// another pose was merged meanwhile; if its scan is in the bin, both return.
  /// @throws Error "no-such-scan", "data-failed", "disk-full", "write-failed"
  void restore(std::string_view id);

  /// Removes the scans in the bin permanently.
  void empty_bin();

  /// Removes scans from the bin, first deleted first, until `needed` bytes are free. Removes none
  /// if the space of all of them would not suffice.
  /// @param what  what is to be written, such as "a model"
  /// @throws Error "disk-full"  if the space does not suffice
  void make_room(std::uint64_t needed, const std::string& what);

  /// Makes a temporary folder for a scan from another Octurn. The next start removes leftovers.
  /// @throws Error "data-failed", "disk-full"
  std::filesystem::path begin_import();

  /// Adds a filled folder of `begin_import` as a scan that waits for its model.
  /// @throws Error  if it cannot be read, "disk-full", "write-failed"
  Job adopt(const std::filesystem::path& beginning);

  /// Makes the folder of a new build; the next start removes it if it stays unfinished.
  /// @return the path of its `Scan.stl`
  /// @throws Error "no-such-scan", "disk-full"  if a model may not fit, "data-failed"
  std::filesystem::path begin_build(std::string_view id, int number);

  /// Returns the number of the next build of a scan. @throws Error "no-such-scan"
  int next_build(std::string_view id) const;

  /// Adds a build whose model is at the path of `begin_build`, atomically.
  /// @throws Error "no-such-scan", "disk-full", "write-failed", "data-failed"
  void add_build(std::string_view id, const Build& build);

  /// Reserves the number and the folder of a build that another process makes.
  /// @param run  gets its number
  /// @return the folder, which is a build as soon as it contains `build.json`
  /// @throws Error "no-such-scan", "disk-full"  if a model may not fit, "data-failed"
  std::filesystem::path reserve_build(BuildRun& run);

  /// Adds a build that another process has made in its reserved folder.
  /// @throws Error "no-such-scan", "job-malformed", "read-failed"
  void take_build(std::string_view id, int number);

  /// Removes the reserved folder of a build that will not be made.
  void release_build(std::string_view id, int number);

  /// Removes the folder of a build that will not be finished.
  void drop_build(std::string_view id, int number);

  /// Chooses a build's model as the scan's; build 0 is the scan's own model.
  /// @throws Error "no-such-scan", "no-model"  if there is no such build, "disk-full",
  /// "write-failed"
  void choose_build(std::string_view id, int number);

  /// @throws Error "no-such-scan", "no-model"  if there is no such build, "busy"  if it is chosen
  void remove_build(std::string_view id, int number);

  /// Returns the scan folder for builds with these other poses: that of the build that merged them;
  /// without poses, the scan's own. @throws Error "no-model"  if there is none
  std::filesystem::path merged_scan(std::string_view id,
                                    const std::vector<std::string>& poses) const;

  /// Removes the builds that include that pose. If one of them is chosen, the model chosen before
  /// it is restored. @throws  as `choose_build` and `remove_build`
  void withdraw_pose(std::string_view id, const std::string& pose);

  /// The data folder.
  const std::filesystem::path& data() const { return data_; }

  /// @param id  that exists
  std::filesystem::path folder(std::string_view id) const;
  /// Returns the path of the scan's model, that of the chosen build.
  std::filesystem::path model_file(std::string_view id) const;
  /// Returns the path of a build's model; build 0 is the scan's own.
  std::filesystem::path model_file(std::string_view id, int build) const;

  /// Returns the platform's last stored angle, degrees; 0 if there is none.
  double platform_angle_deg() const;
  void save_platform_angle_deg(double angle_deg) const;

  std::uint64_t free_bytes() const;

  /// A number that changes whenever a scan is added, ends, is labelled, built again or removed, so
  /// that lists of scans can be cached. It is not comparable between processes.
  std::uint64_t revision() const;

 private:
  ScanTime next_time() const;
  void enter(const std::filesystem::path& beginning, const Job& job);
  void recover();
  void finish_discards();
  ScanTime now() const;
  void expire_bin();
  void list(const Job& job);
  void move_from_bin(const BinnedScan& scan);
  void restore_with_poses(const BinnedScan& first);
  void move_builds_out(const Job& first, const std::string& pose);
  int move_builds_back(const Job& pose);
  void rejoin(const Job& pose);
  void move_to_bin(const Job& job);
  void write_job(const Job& job) const;
  void keep(const Job& job);

  std::filesystem::path data_;
  std::filesystem::path scans_;
  std::filesystem::path platform_;
  WallClock clock_;
  FileDescriptor lock_;  // keeps the data folder locked
  ScanBin bin_;
  std::mutex writing_;        // serialises writes of a scan's files; locked before mutex_
  mutable std::mutex mutex_;  // guards the members below; never held during disk access
  std::map<std::string, Job, std::greater<>> jobs_;
  std::uint64_t revision_;
};

}  // namespace octurn
