#pragma once

#include <string>

namespace octurn {

/// Loads a module of this program, which stays loaded, from the folder that OpenNI2 is found in.
/// @param library  "libOcturnHttpClient.so"
/// @param symbol   what it offers
/// @param what     the module's name for people
/// @param hint     what to do where it cannot be loaded
/// @return the address of the symbol
/// @throws Error "internal"
const void* load_module(const char* library, const char* symbol, const std::string& what,
                        const std::string& hint);

}  // namespace octurn
