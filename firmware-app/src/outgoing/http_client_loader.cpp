#include <dlfcn.h>

#include "octurn/error.hpp"
#include "outgoing/http_client_module.hpp"

namespace octurn {
namespace {

/// The module, which stays loaded. It lies in the folder that this program finds OpenNI2 in.
const HttpClientModule& loaded_module() {
  static const HttpClientModule& module = []() -> const HttpClientModule& {
    void* const library = ::dlopen("libOcturnHttpClient.so", RTLD_NOW | RTLD_LOCAL);
    const void* const symbol =
        library == nullptr ? nullptr : ::dlsym(library, "octurn_http_client");
    if (symbol == nullptr) {
      const char* const trouble = ::dlerror();
      throw Error(ErrorCode::internal,
                  std::string("the HTTP client cannot be loaded: ") +
                      (trouble == nullptr ? "it has no entry" : trouble),
                  "Install Octurn again, and libcurl.");
    }
    return *static_cast<const HttpClientModule*>(symbol);
  }();
  return module;
}

}  // namespace

OutgoingAnswer ask(const OutgoingRequest& request, const std::stop_token& stop,
                   const std::function<void(std::uint64_t)>& on_sent) {
  return loaded_module().ask(request, stop, on_sent);
}

std::string origin_of(const std::string& url) { return loaded_module().origin_of(url); }

std::string to_path_part(const std::string& text) { return loaded_module().to_path_part(text); }

}  // namespace octurn
