#pragma once

#include <string>

#include "octurn/error.hpp"

namespace octurn {

/// What an error concerns.
enum class Device { none, sensor, turntable };

/// Why something did not work, as the API tells it.
struct Failure {
  ErrorCode code = ErrorCode::internal;
  std::string detail = {};
  std::string hint = {};

  /// The device that it concerns: a person can mend that while a scan waits.
  Device device() const;
  /// Whether the device is not there, rather than broken.
  bool is_absence() const;
};

Failure failure_of(const Error& error);

/// The exception that is being handled; one that is no Error becomes "internal". Only in a `catch`.
Failure current_failure();

/// The exception that a failure came from, or an equal one.
Error to_error(const Failure& failure);

}  // namespace octurn
