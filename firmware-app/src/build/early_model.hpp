#pragma once

#include <filesystem>
#include <future>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>

#include "octurn/error.hpp"
#include "octurn/model.hpp"
#include "octurn/quality.hpp"
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

/// Quality code of a model that is coarser than requested because it exceeded the memory limit.
inline constexpr std::string_view coarser_code = "coarser";

/// The reconstruction of a running scan. It logs a warning if the model may exceed the memory
/// limit. If the limit is exceeded, it restarts with larger leaves, so that the turn is not lost.
class FittingReconstruction {
 public:
  /// @throws  as `make_reconstructor`, so that impossible options are refused before the platform
  ///         turns
  explicit FittingReconstruction(const ReconstructOptions& options);

  Reconstructor& operator*() { return *reconstruction_; }
  const ReconstructOptions& options() const { return options_; }

  /// Restarts the reconstruction without snapshots.
  void start_again();

  /// Restarts it with another clip box.
  void start_again(const Box& clip);

  /// Restarts one level coarser after an error "memory-limit".
  /// @throws Error  `error` if it is another one, or the leaves cannot grow
  void make_coarser(const Error& error);

  /// Adds a reason to the verdict if the leaves are larger than requested.
  void add_coarser_reason(Quality& quality) const;

 private:
  std::string detail() const;

  ReconstructOptions options_;
  double asked_leaf_size_;
  std::unique_ptr<Reconstructor> reconstruction_;
};

}  // namespace octurn
