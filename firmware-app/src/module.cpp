#include "module.hpp"

#include <dlfcn.h>

#include "octurn/error.hpp"

namespace octurn {

const void* load_module(const char* library, const char* symbol, const std::string& what,
                        const std::string& hint) {
  void* const loaded = ::dlopen(library, RTLD_NOW | RTLD_LOCAL);
  const void* const found = loaded == nullptr ? nullptr : ::dlsym(loaded, symbol);
  if (found == nullptr) {
    const char* const trouble = ::dlerror();
    throw Error(ErrorCode::internal,
                what + " cannot be loaded: " +
                    (trouble == nullptr ? std::string("it has no symbol ") + symbol : trouble),
                hint);
  }
  return found;
}

}  // namespace octurn
