#include "scan/failure_json.hpp"

#include <nlohmann/json.hpp>

namespace octurn {

nlohmann::json to_json(const Failure& failure) {
  return {{"code", to_string(failure.code)}, {"detail", failure.detail}, {"hint", failure.hint}};
}

}  // namespace octurn
