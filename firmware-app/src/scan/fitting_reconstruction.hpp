#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "octurn/error.hpp"
#include "octurn/quality.hpp"
#include "octurn/reconstruct.hpp"

namespace octurn {

/// The reason's code: the model is coarser than was asked for, as it did not fit into the memory.
inline constexpr std::string_view coarser_code = "coarser";

/// The reconstruction of a scan, which logs that it may not fit into the memory, and becomes
/// coarser where it does not: what a turn took minutes for is not lost.
class FittingReconstruction {
 public:
  /// @throws  as `make_reconstructor`: what cannot fit is refused before the platform turns
  explicit FittingReconstruction(const ReconstructOptions& options);

  Reconstructor& operator*() { return *reconstruction_; }
  const ReconstructOptions& options() const { return options_; }

  /// Gives up all that was added.
  void start_again();

  /// Starts again a level coarser, if that is what an error asks for. @throws that error  if not
  void make_coarser(const Error& error);

  /// Tells a verdict that the leaves are not those that were asked for, if so.
  void tell(Quality& quality) const;

 private:
  std::string detail() const;

  ReconstructOptions options_;
  double asked_leaf_size_;
  std::unique_ptr<Reconstructor> reconstruction_;
};

}  // namespace octurn
