#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "appliance/appliance.hpp"
#include "failure.hpp"
#include "http/message.hpp"

namespace octurn {

/// Takes host and client of a request from X-Forwarded-Host and X-Forwarded-For if a trusted proxy
/// has sent it. Each proxy adds its value at the end: the client is the last that is no such proxy.
/// @param address  of the sender; becomes that of the client
void take_forwarded(Request& request, std::string& address,
                    std::span<const std::string> trusted_proxies);

/// Whether a request may be answered at all, and may change something.
///
/// Any page that is open in a browser can send requests here. Two rules keep other sites out. The
/// `Host` must be a name that nobody else can own (an address, a name of the local network, or one
/// of `host_names`), which defeats DNS rebinding. And a request that changes something must have a
/// `Content-Type` that no form can send, and an `Origin`, if any, of this host. Where a browser
/// says so, as it does over TLS, a page of another site cannot even read the API, which costs work.
///
/// @param body_type  that `Content-Type`: JSON, or upload_type
/// @return the reason of a refusal, or nothing
std::optional<Failure> refusal(const Request& request, std::span<const std::string> host_names,
                               std::string_view body_type = "application/json");

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
