#include "module.hpp"
#include "outgoing/http_client_module.hpp"

namespace octurn {
namespace {

const HttpClientModule& loaded_module() {
  static const auto& module = *static_cast<const HttpClientModule*>(
      load_module("libOcturnHttpClient.so", "octurn_http_client", "the HTTP client",
                  "Install Octurn again, and libcurl."));
  return module;
}

}  // namespace

OutgoingAnswer ask(const OutgoingRequest& request, const std::stop_token& stop,
                   const std::function<void(std::uint64_t)>& on_sent) {
  return loaded_module().ask(request, stop, on_sent);
}

std::string to_origin(const std::string& url) { return loaded_module().to_origin(url); }

std::string to_path_part(const std::string& text) { return loaded_module().to_path_part(text); }

}  // namespace octurn
