#pragma once

#include "outgoing/http_client.hpp"

namespace octurn {

/// Functions of the module libOcturnHttpClient. It is loaded at the first use, as libcurl and its
/// dependencies take 5 MB, which a program without outgoing requests saves.
struct HttpClientModule {
  OutgoingAnswer (*ask)(const OutgoingRequest& request, const std::stop_token& stop,
                        const std::function<void(std::uint64_t)>& on_sent) = nullptr;
  std::string (*to_origin)(const std::string& url) = nullptr;
  std::string (*to_path_part)(const std::string& text) = nullptr;
};

}  // namespace octurn

extern "C" __attribute__((visibility("default"))) const octurn::HttpClientModule octurn_http_client;
