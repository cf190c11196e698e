#pragma once

#include <string>

#include "octurn/error.hpp"

namespace octurn {

/// The device that an error concerns.
enum class Device { none, sensor, turntable };

/// An error as a value, as the API reports it.
struct Failure {
  ErrorCode code = ErrorCode::internal;
  std::string detail = {};
  std::string hint = {};
  Parameters parameters = {};  ///< the values in `detail`

  /// The device that failed, or `none`. A scan waits until a person has repaired it.
  Device device() const;
  /// Whether the device is missing, rather than broken.
  bool is_absence() const;
};

/// An error as a value.
Failure to_failure(const Error& error);

/// The exception that is being handled; other types than Error become "internal". Call it only in a
/// `catch`.
Failure current_failure();

/// Converts a failure back to the exception.
Error to_error(const Failure& failure);

}  // namespace octurn
