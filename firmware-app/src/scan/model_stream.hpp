#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <stop_token>

#include "octurn/reconstruct.hpp"
#include "octurn/scan_folder.hpp"
#include "scan/scanner.hpp"

namespace octurn {

/// A model made from a stored scan while it is sent: it needs no disk, and of memory no more than
/// the options say.
class ModelStream {
 public:
  /// Reads the snapshots, and counts what the model will have.
  ///
  /// @param options  but for the clip box, which is the scan's
  /// @throws Error  if a snapshot is damaged, the model is empty or does not fit into memory
  /// @throws Error "busy"  if a scan starts meanwhile
  ModelStream(const std::filesystem::path& folder, ReconstructOptions options,
              std::unique_ptr<Scanner::Leave> leave);
  ~ModelStream() = default;
  ModelStream(const ModelStream&) = delete;
  ModelStream& operator=(const ModelStream&) = delete;

  std::uint64_t bytes() const;

  /// That a scan has started, which ends this one.
  std::stop_token stop() const { return leave_->stop(); }

  /// Hands the STL over, once. Ends early if `sink` returns false or a scan starts.
  void send(const std::function<bool(std::span<const std::byte>)>& sink);

 private:
  std::unique_ptr<Scanner::Leave> leave_;
  Scan scan_;
  SnapshotSource snapshots_;
  std::unique_ptr<Reconstructor> reconstruction_;
  SurfaceCount count_ = {};
};

}  // namespace octurn
