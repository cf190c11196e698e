#pragma once

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/time.h>

#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>
#include <utility>

#include "file_descriptor.hpp"
#include "http/message.hpp"
#include "support/patience.hpp"

namespace octurn {

/// The response that came over a connection until its end.
struct Reply {
  int status = 0;  ///< 0: no answer
  Headers headers = {};
  std::string body = {};

  std::string header(std::string_view name) const {
    for (const auto& [key, value] : headers) {
      if (same_token(key, name)) {
        return value;
      }
    }
    return "";
  }
};

inline sockaddr_in internet_address(std::uint32_t host, int port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(host);
  return address;
}

/// Connects from another client address; all of 127.0.0.0/8 are local.
inline FileDescriptor connected_from(std::uint32_t client, int port) {
  FileDescriptor socket(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  const sockaddr_in own = internet_address(client, 0);
  EXPECT_EQ(::bind(socket.number(), reinterpret_cast<const sockaddr*>(&own), sizeof own), 0);
  const sockaddr_in address = internet_address(INADDR_LOOPBACK, port);
  const timeval limit{.tv_sec = patience.count(), .tv_usec = 0};
  ::setsockopt(socket.number(), SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
  EXPECT_EQ(::connect(socket.number(), reinterpret_cast<const sockaddr*>(&address), sizeof address),
            0);
  return socket;
}

inline FileDescriptor connected(int port) { return connected_from(INADDR_LOOPBACK, port); }

inline void send_text(const FileDescriptor& socket, std::string_view text) {
  while (!text.empty()) {
    const ssize_t sent = ::send(socket.number(), text.data(), text.size(), MSG_NOSIGNAL);
    if (sent <= 0) {
      return;  // the server stopped reading; its response can still be read
    }
    text.remove_prefix(static_cast<std::size_t>(sent));
  }
}

/// Reads until the server closes the connection. The test fails if the server keeps the connection
/// open and silent for `patience`.
inline std::string receive_all(const FileDescriptor& socket) {
  std::string text;
  std::string part(65536, '\0');
  for (ssize_t got = 1; got > 0;) {
    got = ::recv(socket.number(), part.data(), part.size(), 0);
    EXPECT_FALSE(got < 0 && errno == EAGAIN) << "the connection is still open";
    text.append(part, 0, static_cast<std::size_t>(got > 0 ? got : 0));
  }
  return text;
}

inline Reply reply_from(std::string_view text) {
  Reply reply;
  const std::size_t head = text.find("\r\n\r\n");
  if (!text.starts_with("HTTP/1.1 ") || head == std::string_view::npos) {
    return reply;
  }
  reply.status = std::atoi(std::string(text.substr(9, 3)).c_str());
  reply.body = text.substr(head + 4);
  for (std::size_t at = text.find("\r\n"); at < head;) {
    const std::size_t end = text.find("\r\n", at + 2);
    const std::string_view line = text.substr(at + 2, end - at - 2);
    const std::size_t colon = line.find(": ");
    reply.headers.emplace_back(line.substr(0, colon), line.substr(colon + 2));
    at = end;
  }
  return reply;
}

/// Sends a text verbatim, and reads the response until the connection ends.
inline Reply reply_to(int port, std::string_view text) {
  const FileDescriptor socket = connected(port);
  send_text(socket, text);
  return reply_from(receive_all(socket));
}

/// Sends a request with the headers that the page would send.
inline Reply request(int port, std::string_view method, std::string_view path,
                     std::string_view body = "", const Headers& headers = {}) {
  std::string text;
  text.append(method).append(" ").append(path).append(" HTTP/1.1\r\n");
  text += "Host: localhost:" + std::to_string(port) + "\r\n";
  if (method != "GET" && method != "HEAD") {
    text += "Content-Type: application/json\r\n";
    text += "Content-Length: " + std::to_string(body.size()) + "\r\n";
  }
  for (const auto& [name, value] : headers) {
    text.append(name).append(": ").append(value).append("\r\n");
  }
  return reply_to(port, text.append("\r\n").append(body));
}

}  // namespace octurn
