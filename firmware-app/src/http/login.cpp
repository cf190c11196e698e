#include "http/login.hpp"

#include <civetweb.h>

#include <array>
#include <cstdio>
#include <random>
#include <system_error>
#include <utility>

#include "http/json_body.hpp"
#include "http/password_file.hpp"
#include "log.hpp"
#include "random_digits.hpp"

namespace octurn {
namespace {

// A nonce is its period, its number and its session's, 16 hexadecimal digits each, and their
// signature. A session's number is that of its first nonce.
constexpr std::size_t number_digits = 16;
constexpr std::size_t text_digits = 3 * number_digits;
constexpr std::size_t signature_digits = 32;

// Maximum number of proofs remembered for the nonces of one period. The page sends about one a
// second, so that only an attacker reaches it.
constexpr std::size_t max_used = 100'000;

std::string to_hexadecimal(std::uint64_t number) {
  std::array<char, number_digits + 1> text{};
  std::snprintf(text.data(), text.size(), "%016llx", static_cast<unsigned long long>(number));
  return text.data();
}

std::int64_t to_period(Login::Time time) { return time.time_since_epoch() / Login::period; }

std::int64_t period_of_nonce(const std::string& nonce) {
  return static_cast<std::int64_t>(std::stoull(nonce.substr(0, number_digits), nullptr, 16));
}

std::string session_of_nonce(const std::string& nonce) {
  return nonce.substr(2 * number_digits, number_digits);
}

// A browser that has sent a password shows this, and tries again by itself. It is whole, as the
// page's files need the password, too.
constexpr const char* waiting_page = R"(<!doctype html>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>Octurn</title>
<p lang="en">Please wait: somebody is guessing the password. Your browser tries again by itself.</p>
<p lang="de">Bitte warten: jemand rät das Passwort. Ihr Browser versucht es von selbst wieder.</p>
<p lang="es">Espere: alguien intenta adivinar la contraseña. Su navegador lo intenta de nuevo solo.</p>
<p lang="fr">Patientez : quelqu’un cherche à deviner le mot de passe. Votre navigateur réessaie seul.</p>
)";

Response refuse_guess(Reader reader) {
  Response response =
      problem({.code = ErrorCode::too_many_guesses,
               .detail = "too many wrong passwords are being tried",
               .hint = "Try the right one again each second: chance decides which is checked."});
  if (reader == Reader::person) {
    response.headers = {{"Content-Type", "text/html; charset=utf-8"}, {"Refresh", "1"}};
    response.body = waiting_page;
  }
  response.headers.emplace_back("Retry-After", "1");
  return response;
}

}  // namespace

Login::Login(std::filesystem::path password_file, std::filesystem::path own_file)
    : password_file_(std::move(password_file)),
      own_file_(std::move(own_file)),
      secret_(random_digits(secret_bytes)) {}

/// The file of the password; empty: there is none. One that cannot be looked at is in force.
std::filesystem::path Login::file_in_force() const {
  std::error_code error;
  const auto status = std::filesystem::symlink_status(own_file_, error);
  return own_file_.empty() || status.type() == std::filesystem::file_type::not_found
             ? password_file_
             : own_file_;
}

/// The secret is on both sides, as MD5 of a secret and a text is open to length extension.
std::string Login::sign(const std::string& text) const {
  std::array<char, signature_digits + 1> signature{};
  mg_md5(signature.data(), secret_.c_str(), text.c_str(), secret_.c_str(), nullptr);
  return signature.data();
}

/// @param session  empty: a new one
std::string Login::make_nonce(const std::string& session, std::int64_t now) {
  const std::string number = to_hexadecimal(++nonces_);
  const std::string text = to_hexadecimal(static_cast<std::uint64_t>(now)) + number +
                           (session.empty() ? number : session);
  return text + sign(text);
}

bool Login::is_own(const std::string& nonce) const {
  return nonce.size() == text_digits + signature_digits &&
         sign(nonce.substr(0, text_digits)) == nonce.substr(text_digits);
}

/// Marks a correct proof with a fresh nonce as used. @return false if it was used before
bool Login::is_first_use(const DigestProof& proof, std::int64_t now) {
  std::erase_if(used_, [&](const auto& entry) { return now - entry.first > 1; });
  std::set<std::string>& used = used_[period_of_nonce(proof.nonce)];
  if (used.size() >= max_used) {
    secret_ =
        random_digits(secret_bytes);  // invalidates all nonces, so no proof need be remembered
    used_.clear();
    return false;
  }
  return used.insert(proof.response).second;
}

Response Login::challenge(const std::string& session, Freshness proof, std::int64_t now) {
  Response response = problem({.code = ErrorCode::password_needed,
                               .detail = "the page has a password",
                               .hint = std::string("The user is ") + page_user + "."});
  response.headers.emplace_back(
      "WWW-Authenticate",
      std::string("Digest realm=\"") + page_realm + R"(", qop="auth", algorithm=MD5, nonce=")" +
          make_nonce(session, now) + "\"" + (proof == Freshness::stale ? ", stale=true" : ""));
  return response;
}

void Login::count_wrong(const std::string& address, Time now) {
  std::random_device random;
  guesses_.count_wrong(address, now, std::exponential_distribution<double>{}(random));
  if (!guesses_.allows(address, now)) {
    log::warning("http", "too many wrong passwords from " + address);
  }
}

std::optional<Response> Login::refusal(const LoginAttempt& attempt, Time now) {
  const std::filesystem::path file = file_in_force();
  if (file.empty()) {
    return std::nullopt;
  }
  const std::optional<std::string> hash = read_password_hash(file);
  const std::int64_t current = to_period(now);
  const std::lock_guard lock(mutex_);
  if (hash != hash_) {
    hash_ = hash;
    guesses_.forget_known();
  }
  const auto proof = parse_digest(attempt.authorization.value_or(""));
  if (!proof) {
    return challenge({}, Freshness::fresh, current);
  }
  const std::string session = is_own(proof->nonce) ? session_of_nonce(proof->nonce) : "";
  const bool is_known = guesses_.knows(session);
  if (!is_known && !guesses_.allows(attempt.address, now)) {
    return refuse_guess(attempt.reader);
  }
  if (!hash || proof->user != page_user || proof->realm != page_realm || proof->qop != "auth" ||
      proof->response != digest_response(*proof, *hash, attempt.method)) {
    if (!is_known) {
      count_wrong(attempt.address, now);
    }
    return challenge(session, Freshness::fresh, current);
  }
  if (proof->uri != attempt.target) {
    return challenge(session, Freshness::fresh, current);
  }
  if (session.empty() || current - period_of_nonce(proof->nonce) > 1 ||
      !is_first_use(*proof, current)) {
    // The password was right: its session starts, so that the next proof need not be lucky again.
    // Each outdated nonce starts one session only, so that repeated proofs push out no other's.
    const std::string proved =
        session.empty() ? sign(proof->nonce).substr(0, number_digits) : session;
    guesses_.remember(proved, attempt.address, now);
    return challenge(proved, Freshness::stale, current);
  }
  guesses_.remember(session, attempt.address, now);
  return std::nullopt;
}

}  // namespace octurn
