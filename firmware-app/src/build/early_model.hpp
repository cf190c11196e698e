#pragma once

#include <filesystem>
#include <future>
#include <optional>
#include <stop_token>

#include "octurn/model.hpp"
#include "octurn/reconstruct.hpp"
#include "octurn/stl.hpp"

namespace octurn {

/// A model that is built speculatively, on its own thread. Its file is temporary until `finish`
/// renames it.
class EarlyModel {
 public:
  EarlyModel() = default;
  ~EarlyModel() { give_up(); }
  EarlyModel(const EarlyModel&) = delete;
  EarlyModel& operator=(const EarlyModel&) = delete;

  /// Starts the thread.
  /// @param reconstructor  used by the thread alone until `finish` or `give_up`
  /// @throws Error "write-failed"  if the folder cannot be written to
  void begin(Reconstructor& reconstructor, SnapshotSource snapshots,
             const std::filesystem::path& file);

  bool has_begun() const { return report_.valid(); }

  /// Waits for the model, and renames its file. @return nullopt if stopped first
  /// @throws Error  as `write_model`
  std::optional<ModelReport> finish(const std::stop_token& stop);

  /// Stops the thread, if it was started, and removes the file.
  void give_up();

 private:
  std::stop_source stop_;
  std::optional<StlFile> file_;
  std::future<std::optional<ModelReport>> report_;
};

}  // namespace octurn
