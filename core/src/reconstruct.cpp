#include "octurn/reconstruct.hpp"

#include "bennett/bennett_reconstructor.hpp"
#include "tsdf/solid_reconstructor.hpp"

namespace octurn {

std::string_view to_string(Method method) {
  return method == Method::solid ? "solid" : "intersection";
}

std::optional<Method> method_named(std::string_view name) {
  for (const Method method : {Method::intersection, Method::solid}) {
    if (to_string(method) == name) {
      return method;
    }
  }
  return std::nullopt;
}

std::string_view to_string(Parts parts) { return parts == Parts::main ? "main" : "all"; }

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
