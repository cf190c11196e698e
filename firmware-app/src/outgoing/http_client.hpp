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

/// An HTTP or HTTPS request to another program. It goes to this address and nowhere else: no proxy
/// is used, and no redirect is followed.
struct OutgoingRequest {
  std::string method = "GET";
  std::string url = {};
  std::vector<std::string> headers = {};  ///< "X-Api-Key: secret"
  std::string body = {};
  std::filesystem::path file = {};  ///< sent in place of the body; empty: the body is sent
  /// If not empty, the file is sent under that name in the field `file` of a form (RFC 7578).
  std::string form_name = {};
  std::vector<std::pair<std::string, std::string>> fields = {};  ///< further ones of the form
  std::string user = {};                                         ///< for HTTP Digest; empty: none
  std::string password = {};
  /// SHA-256 of the one public key that the server may have over TLS, whoever signed it, as
  /// "sha256//BASE64". Empty: any whose certificate an authority of the system signed.
  std::string fingerprint = {};
  std::chrono::milliseconds time_limit = std::chrono::seconds(10);  ///< for the whole exchange
  std::chrono::seconds still_limit{30};                             ///< in which no byte moves
};

/// The answer to a request, or the reason why there is none.
struct OutgoingAnswer {
  int status = 0;            ///< of HTTP; 0: there was no answer
  std::string body = {};     ///< its first 64 KiB
  std::string trouble = {};  ///< readable reason why there was no answer
  /// The reason is the server's certificate, whose public key has this fingerprint. Nothing was
  /// sent to it.
  std::string fingerprint = {};
};

/// Sends a request and waits for the answer. Gives up if connecting takes 5 s.
/// @param stop     aborts the request at once
/// @param on_sent  called repeatedly with the number of bytes sent of the body or the form
OutgoingAnswer ask(const OutgoingRequest& request, const std::stop_token& stop,
                   const std::function<void(std::uint64_t)>& on_sent = {});

/// The origin (scheme, host, port) of a web address: "http://printer.local:5000". Empty if the
/// address is malformed, or has a user, a password or a fragment.
std::string to_origin(const std::string& url);

/// Percent-encodes a text as a segment of a path (RFC 3986).
std::string to_path_part(const std::string& text);

}  // namespace octurn
