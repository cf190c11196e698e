#include <curl/curl.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <memory>
#include <optional>
#include <string_view>
#include <system_error>

#include "outgoing/http_client_module.hpp"

namespace octurn {
namespace {

constexpr std::size_t max_answer = std::size_t{64} << 10U;  // bytes
constexpr long connect_seconds = 5;
constexpr int poll_ms = 1000;
// No server has this public key.
constexpr const char* nobodys_fingerprint = "sha256//AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA=";

/// Deleter of a C library's object.
template <auto release>
struct Release {
  template <typename T>
  void operator()(T* object) const {
    release(object);
  }
};
using Easy = std::unique_ptr<CURL, Release<curl_easy_cleanup>>;
using Multi = std::unique_ptr<CURLM, Release<curl_multi_cleanup>>;
using Lines = std::unique_ptr<curl_slist, Release<curl_slist_free_all>>;
using Form = std::unique_ptr<curl_mime, Release<curl_mime_free>>;
using Address = std::unique_ptr<CURLU, Release<curl_url_cleanup>>;
using File = std::unique_ptr<std::FILE, Release<std::fclose>>;

void begin_with_curl() {
  [[maybe_unused]] static const CURLcode begun = curl_global_init(CURL_GLOBAL_DEFAULT);
}

extern "C" std::size_t keep_answer(char* bytes, std::size_t size, std::size_t count,
                                   void* answer) noexcept {
  std::string& kept = *static_cast<std::string*>(answer);
  const std::size_t room = max_answer - std::min(max_answer, kept.size());
  kept.append(bytes, std::min(room, size * count));
  return size * count;
}

/// Keeps the fingerprint that libcurl logs when it compares a public key with the expected one. It
/// has no other way to tell it, and a TLS library is not linked for this alone.
extern "C" int keep_fingerprint(CURL* /*easy*/, curl_infotype type, char* text, std::size_t size,
                                void* fingerprint) noexcept {
  constexpr std::string_view start = "public key hash: ";
  std::string_view line(text, size);
  line.remove_prefix(std::min(line.find_first_not_of(" \t"), size));
  if (type == CURLINFO_TEXT && line.starts_with(start)) {
    line.remove_prefix(start.size());
    *static_cast<std::string*>(fingerprint) = line.substr(0, line.find_first_of(" \r\n"));
  }
  return 0;
}

/// A request in progress, with all objects that libcurl refers to.
class Transfer {
 public:
  explicit Transfer(const OutgoingRequest& request) : easy_(curl_easy_init()) {
    set(CURLOPT_URL, request.url.c_str());
    set(CURLOPT_CUSTOMREQUEST, request.method.c_str());
    limit(request);
    set_credentials(request);
    set_fingerprint(request.fingerprint);
    add_headers(request.headers);
    add_body(request);
    set(CURLOPT_WRITEFUNCTION, keep_answer);
    set(CURLOPT_WRITEDATA, &answer_.body);
    set(CURLOPT_ERRORBUFFER, reason_.data());
  }

  CURL* get() const { return easy_.get(); }

  /// Whether it ended since the server's certificate, or its public key, is not trusted.
  bool is_untrusted() const { return is_untrusted_; }

  /// Of the server, once its public key was compared with the request's.
  const std::string& fingerprint() const { return fingerprint_; }

  /// The reason why the request cannot be sent; empty if it can.
  const std::string& trouble() const { return answer_.trouble; }

  std::uint64_t sent() const {
    curl_off_t bytes = 0;
    curl_easy_getinfo(easy_.get(), CURLINFO_SIZE_UPLOAD_T, &bytes);
    return static_cast<std::uint64_t>(std::max<curl_off_t>(bytes, 0));
  }

  /// @param result  nothing: it was stopped
  OutgoingAnswer finish(std::optional<CURLcode> result) {
    if (!result) {
      answer_.trouble = "it was stopped";
    } else if (*result != CURLE_OK) {
      answer_.trouble = reason_[0] != '\0' ? reason_.data() : curl_easy_strerror(*result);
      is_untrusted_ = *result == CURLE_PEER_FAILED_VERIFICATION ||
                      *result == CURLE_SSL_CACERT_BADFILE ||
                      *result == CURLE_SSL_PINNEDPUBKEYNOTMATCH;
    } else {
      long status = 0;
      curl_easy_getinfo(easy_.get(), CURLINFO_RESPONSE_CODE, &status);
      answer_.status = static_cast<int>(status);
    }
    return std::move(answer_);
  }

 private:
  template <typename T>
  void set(CURLoption option, T value) {
    curl_easy_setopt(easy_.get(), option, value);
  }

  void limit(const OutgoingRequest& request) {
    set(CURLOPT_NOSIGNAL, 1L);  // signals are not safe with several threads
    set(CURLOPT_QUICK_EXIT, 1L);
    set(CURLOPT_PROTOCOLS_STR, "http,https");
    set(CURLOPT_FOLLOWLOCATION, 0L);
    set(CURLOPT_PROXY, "");
    set(CURLOPT_CONNECTTIMEOUT, connect_seconds);
    set(CURLOPT_TIMEOUT_MS, static_cast<long>(request.time_limit.count()));
    set(CURLOPT_LOW_SPEED_LIMIT, 1L);
    set(CURLOPT_LOW_SPEED_TIME, static_cast<long>(request.still_limit.count()));
  }

  void set_credentials(const OutgoingRequest& request) {
    if (!request.user.empty()) {
      set(CURLOPT_HTTPAUTH, CURLAUTH_DIGEST);
      set(CURLOPT_USERNAME, request.user.c_str());
      set(CURLOPT_PASSWORD, request.password.c_str());
    }
  }

  void set_fingerprint(const std::string& fingerprint) {
    if (!fingerprint.empty()) {  // decides alone, in place of authorities and names
      set(CURLOPT_PINNEDPUBLICKEY, fingerprint.c_str());
      set(CURLOPT_SSL_VERIFYPEER, 0L);
      set(CURLOPT_SSL_VERIFYHOST, 0L);
    }
    if (fingerprint == nobodys_fingerprint) {
      set(CURLOPT_VERBOSE, 1L);
      set(CURLOPT_DEBUGFUNCTION, keep_fingerprint);
      set(CURLOPT_DEBUGDATA, &fingerprint_);
    }
  }

  void add_headers(const std::vector<std::string>& headers) {
    for (const std::string& header : headers) {
      lines_.reset(curl_slist_append(lines_.release(), header.c_str()));
    }
    set(CURLOPT_HTTPHEADER, lines_.get());
  }

  void add_body(const OutgoingRequest& request) {
    if (request.file.empty()) {
      if (!request.body.empty()) {
        set(CURLOPT_POSTFIELDSIZE_LARGE, static_cast<curl_off_t>(request.body.size()));
        set(CURLOPT_COPYPOSTFIELDS, request.body.data());
      }
      return;
    }
    std::error_code unreadable;
    const auto bytes = std::filesystem::file_size(request.file, unreadable);
    file_.reset(std::fopen(request.file.c_str(), "rbe"));
    if (unreadable || file_ == nullptr) {
      answer_.trouble = "the file is no longer there";
    } else if (request.form_name.empty()) {
      set(CURLOPT_UPLOAD, 1L);
      set(CURLOPT_READDATA, file_.get());
      set(CURLOPT_INFILESIZE_LARGE, static_cast<curl_off_t>(bytes));
    } else {
      add_form(request);
    }
  }

  void add_form(const OutgoingRequest& request) {
    form_.reset(curl_mime_init(easy_.get()));
    for (const auto& [name, value] : request.fields) {
      curl_mimepart* const part = curl_mime_addpart(form_.get());
      curl_mime_name(part, name.c_str());
      curl_mime_data(part, value.data(), value.size());
    }
    curl_mimepart* const part = curl_mime_addpart(form_.get());
    curl_mime_name(part, "file");
    curl_mime_filedata(part, request.file.c_str());
    curl_mime_filename(part, request.form_name.c_str());
    curl_mime_type(part, "application/octet-stream");
    set(CURLOPT_MIMEPOST, form_.get());
  }

  File file_ = {};
  std::string fingerprint_ = {};
  Easy easy_;
  Lines lines_ = {};
  Form form_ = {};  // after easy_, so that it is freed first
  std::array<char, CURL_ERROR_SIZE> reason_{};
  OutgoingAnswer answer_ = {};
  bool is_untrusted_ = false;
};

/// The result of the transfer; nothing if it has not ended.
std::optional<CURLcode> find_result(CURLM* multi) {
  int left = 0;
  const CURLMsg* const message = curl_multi_info_read(multi, &left);
  return message != nullptr && message->msg == CURLMSG_DONE ? std::optional(message->data.result)
                                                            : std::nullopt;
}

/// A component of a URL; empty if the URL does not have it.
std::string get_part(CURLU* address, CURLUPart part) {
  char* text = nullptr;
  std::string found;
  if (curl_url_get(address, part, &text, 0) == CURLUE_OK) {
    found = text;
  }
  curl_free(text);
  return found;
}

OutgoingAnswer run(Transfer& transfer, const std::stop_token& stop,
                   const std::function<void(std::uint64_t)>& on_sent) {
  const Multi multi(curl_multi_init());
  curl_multi_add_handle(multi.get(), transfer.get());
  const std::stop_callback wake(stop, [&] { curl_multi_wakeup(multi.get()); });
  int running = 1;
  CURLMcode failed = CURLM_OK;
  while (running > 0 && !stop.stop_requested() &&
         (failed = curl_multi_perform(multi.get(), &running)) == CURLM_OK) {
    if (on_sent) {
      on_sent(transfer.sent());
    }
    if (running > 0) {
      curl_multi_poll(multi.get(), nullptr, 0, poll_ms, nullptr);
    }
  }
  OutgoingAnswer answer = failed == CURLM_OK
                              ? transfer.finish(find_result(multi.get()))
                              : OutgoingAnswer{.trouble = curl_multi_strerror(failed)};
  curl_multi_remove_handle(multi.get(), transfer.get());
  return answer;
}

/// The fingerprint of a server's public key. Nothing is sent to it, as it has not the expected one.
std::string find_fingerprint(const std::string& url, const std::stop_token& stop) {
  Transfer transfer({.url = url, .fingerprint = nobodys_fingerprint});
  run(transfer, stop, {});
  return transfer.fingerprint();
}

OutgoingAnswer ask_by_curl(const OutgoingRequest& request, const std::stop_token& stop,
                           const std::function<void(std::uint64_t)>& on_sent) {
  begin_with_curl();
  Transfer transfer(request);
  if (!transfer.trouble().empty()) {
    return {.trouble = transfer.trouble()};
  }
  OutgoingAnswer answer = run(transfer, stop, on_sent);
  if (transfer.is_untrusted()) {
    answer.fingerprint = find_fingerprint(request.url, stop);
  }
  return answer;
}

std::string find_origin(const std::string& url) {
  begin_with_curl();
  const Address address(curl_url());
  if (curl_url_set(address.get(), CURLUPART_URL, url.c_str(), 0) != CURLUE_OK) {
    return "";
  }
  const std::string scheme = get_part(address.get(), CURLUPART_SCHEME);
  const std::string host = get_part(address.get(), CURLUPART_HOST);
  const std::string port = get_part(address.get(), CURLUPART_PORT);
  const bool has_more = !get_part(address.get(), CURLUPART_USER).empty() ||
                        !get_part(address.get(), CURLUPART_PASSWORD).empty() ||
                        !get_part(address.get(), CURLUPART_FRAGMENT).empty();
  if ((scheme != "http" && scheme != "https") || host.empty() || has_more) {
    return "";
  }
  return scheme + "://" + host + (port.empty() ? "" : ":" + port);
}

std::string escape(const std::string& text) {
  begin_with_curl();
  char* const escaped = curl_easy_escape(nullptr, text.data(), static_cast<int>(text.size()));
  std::string part = escaped != nullptr ? escaped : "";
  curl_free(escaped);
  return part;
}

}  // namespace
}  // namespace octurn

extern "C" const octurn::HttpClientModule octurn_http_client{
    .ask = octurn::ask_by_curl, .to_origin = octurn::find_origin, .to_path_part = octurn::escape};
