#pragma once

#include <filesystem>
#include <future>
#include <optional>
#include <stop_token>

#include "octurn/mesh_report.hpp"
#include "octurn/reconstruct.hpp"
#include "octurn/stl.hpp"

namespace octurn {

/// A model that is made on a thread of its own, while it is found out whether it is wanted. Its
/// file gets its name only if it is.
class EarlyModel {
 public:
  EarlyModel() = default;
  ~EarlyModel() { give_up(); }
  EarlyModel(const EarlyModel&) = delete;
  EarlyModel& operator=(const EarlyModel&) = delete;

  /// @param reconstructor  which nobody else may use until the model is finished or given up
  /// @throws Error "write-failed"  if the folder cannot be written to
  void begin(Reconstructor& reconstructor, SnapshotSource snapshots,
             const std::filesystem::path& file);

  bool has_begun() const { return count_.valid(); }

  /// Waits for it, and writes it. @return nothing if stopped first
  /// @throws Error  as `write_model`
  std::optional<ModelReport> finish(const std::stop_token& stop);

  /// Ends it at once, if it has begun.
  void give_up();

 private:
  std::stop_source stop_;
  std::optional<StlFile> file_;
  MeshCheck check_;
  std::future<std::optional<SurfaceCount>> count_;
};

}  // namespace octurn
