#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "octurn/error.hpp"
#include "octurn/quality.hpp"
#include "octurn/reconstruct.hpp"

namespace octurn {

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
