#pragma once

#include <semaphore>
#include <string>

#include "octurn/error.hpp"

namespace octurn {

/// Holds one of a semaphore's places for its lifetime. A request that waits for a device or for
/// other requests occupies a thread of the server; places limit their number, so that threads stay
/// free for the page and the status.
class Place {
 public:
  /// @param places  null: it holds nothing
  /// @param others  who holds the places, for the message: "others are waiting for the devices"
  /// @throws Error "too-many"  if all are taken
  Place(std::counting_semaphore<>* places, const std::string& others) : places_(places) {
    if (places_ != nullptr && !places_->try_acquire()) {
      throw Error(ErrorCode::too_many, others + " already", "Try again soon.");
    }
  }
  ~Place() {
    if (places_ != nullptr) {
      places_->release();
    }
  }
  Place(const Place&) = delete;
  Place& operator=(const Place&) = delete;

 private:
  std::counting_semaphore<>* places_;
};

}  // namespace octurn
