#pragma once

#include <string>

namespace octurn {

/// Loads a module of this program by dlopen(3), from the RPATH folder that also holds OpenNI2. The
/// module is never unloaded.
/// @param library  file name, such as "libOcturnHttpClient.so"
/// @param symbol   the module's exported symbol
/// @param what     the module's name in the error message
/// @param hint     the hint of the error
/// @return the address of the symbol
/// @throws Error "internal"
const void* load_module(const char* library, const char* symbol, const std::string& what,
                        const std::string& hint);

}  // namespace octurn
