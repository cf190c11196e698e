#pragma once

#include <string>

#include "http/password_file.hpp"

namespace octurn {

/// The request that a digest proof covers.
struct ProvenRequest {
  std::string method = "GET";
  std::string target = "/";
  int uses = 1;  ///< of the nonce, with this one
};

/// The value of `name="value"` in a challenge.
inline std::string quoted_field(const std::string& challenge, const std::string& name) {
  const std::size_t begin = challenge.find(name + "=\"") + name.size() + 2;
  return challenge.substr(begin, challenge.find('"', begin) - begin);
}

/// The Authorization header of a client that uses this password.
inline std::string proof_of(const std::string& password, const std::string& nonce,
                            const ProvenRequest& request = {}) {
  std::string count = std::to_string(request.uses);
  count.insert(0, 8 - count.size(), '0');
  DigestProof proof{.user = "octurn",
                    .realm = "Octurn",
                    .nonce = nonce,
                    .uri = request.target,
                    .qop = "auth",
                    .nc = count,
                    .cnonce = "0a4f113b"};
  proof.response =
      digest_response(proof, digest_hash("octurn", "Octurn", password), request.method);
  return R"(Digest username="octurn", realm="Octurn", nonce=")" + proof.nonce + R"(", uri=")" +
         proof.uri + R"(", qop=auth, nc=)" + proof.nc + R"(, cnonce=")" + proof.cnonce +
         R"(", response=")" + proof.response + "\"";
}

}  // namespace octurn
