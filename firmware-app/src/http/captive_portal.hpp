#pragma once

#include <optional>
#include <span>
#include <string>

#include "appliance/appliance.hpp"
#include "http/message.hpp"

namespace octurn {

/// In the scanner's own WiFi whatever is asked of another host is answered by the page's address,
/// so that a phone that looks for the internet there finds the page, where names lead it here:
/// Android's /generate_204, Apple's /hotspot-detect.html, Windows's /connecttest.txt, Firefox's
/// /success.txt.
///
/// @param host_names  names of this host, besides the local ones
/// @return nothing where the request is for this host, or that WiFi is not on
std::optional<Response> captive_answer(const Request& request,
                                       std::span<const std::string> host_names,
                                       const Appliance& appliance);

}  // namespace octurn
