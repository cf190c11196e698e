#pragma once

#include <optional>
#include <span>
#include <string>

#include "appliance/appliance.hpp"
#include "http/message.hpp"

namespace octurn {

/// In the scanner's own WiFi, requests for other hosts are redirected to the page, so that a phone
/// that probes for the internet shows it: Android's /generate_204, Apple's /hotspot-detect.html,
/// Windows's /connecttest.txt, Firefox's /success.txt.
///
/// @param host_names  names of this host, besides the local ones
/// @return nothing if the request is for this host, or that WiFi is off
std::optional<Response> captive_answer(const Request& request,
                                       std::span<const std::string> host_names,
                                       const Appliance& appliance);

}  // namespace octurn
