#pragma once

#include <cstddef>
#include <span>
#include <string_view>

namespace octurn {

/// Writes bytes to standard output, without a buffer. @throws Error "write-failed"
void write_standard_output(std::span<const std::byte> bytes);
void write_standard_output(std::string_view text);

}  // namespace octurn
