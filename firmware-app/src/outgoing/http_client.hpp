#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <stop_token>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace octurn {

/// What another program is asked, over HTTP or HTTPS. It goes to this address and nowhere else: no
/// proxy, and no redirect is followed.
struct OutgoingRequest {
  std::string method = "GET";
  std::string url = {};
  std::vector<std::string> headers = {};  ///< "X-Api-Key: secret"
  std::string body = {};
  std::filesystem::path file = {};  ///< in place of the body, if there is one
  /// If not empty, the file goes under that name as the field `file` of a form (RFC 7578).
  std::string form_name = {};
  std::vector<std::pair<std::string, std::string>> fields = {};  ///< that the form has beside it
  std::string user = {};                                         ///< for HTTP Digest; empty: none
  std::string password = {};
  std::chrono::milliseconds time_limit = std::chrono::seconds(10);  ///< for all of it
};

/// What came of it.
struct OutgoingAnswer {
  int status = 0;            ///< of HTTP; 0: there was no answer
  std::string body = {};     ///< its first 64 KiB
  std::string trouble = {};  ///< why there was no answer, for people
};

/// Asks, and waits for the answer. A connection that takes 5 s to be made, or stands still for 30
/// s, is given up.
/// @param stop     ends it at once
/// @param on_sent  told now and then how many bytes of the body, or of the form, have been sent
OutgoingAnswer ask(const OutgoingRequest& request, const std::stop_token& stop,
                   const std::function<void(std::uint64_t)>& on_sent = {});

/// Scheme, host and port of a web address: "http://printer.local:5000"; empty if it is none, or has
/// a user, a password or a fragment.
std::string origin_of(const std::string& url);

/// A text as a part of a path (RFC 3986).
std::string to_path_part(const std::string& text);

}  // namespace octurn
