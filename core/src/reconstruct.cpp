#include "octurn/reconstruct.hpp"

#include "bennett/bennett_reconstructor.hpp"
#include "tsdf/solid_reconstructor.hpp"

namespace octurn {

std::unique_ptr<Reconstructor> make_reconstructor(const ReconstructOptions& options) {
  switch (options.method) {
    case Method::intersection:
      return std::make_unique<BennettReconstructor>(options);
    case Method::solid:
      break;
  }
  return std::make_unique<SolidReconstructor>(options);
}

}  // namespace octurn
