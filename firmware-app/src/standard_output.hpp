#pragma once

#include <cstddef>
#include <span>

namespace octurn {

/// Writes bytes to standard output, without a buffer. @throws Error "write-failed"
void write_standard_output(std::span<const std::byte> bytes);

}  // namespace octurn
