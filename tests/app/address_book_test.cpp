#include "outgoing/address_book.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <nlohmann/json.hpp>

#include "support/temporary_folder.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

using nlohmann::json;

Webhook to_webhook(const json& body) {
  JsonObject object(body, ErrorCode::bad_settings, "");
  return webhook_from(object);
}

Printer to_printer(const json& body) {
  JsonObject object(body, ErrorCode::bad_settings, "");
  return printer_from(object);
}

Printer voron() {
  return {.name = "Voron",
          .kind = PrinterKind::moonraker,
          .url = "http://voron.local:7125",
          .key = "secret"};
}

TEST(AddressBook, KeepsWhatItWasGivenForTheNextStart) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "addresses.json";
  AddressBook book(file);
  const std::string id = book.add(Webhook{.url = "http://hub/secret", .events = {"warning"}}).id;
  book.add(voron());

  const AddressBook next(file);
  ASSERT_EQ(next.webhooks().size(), 1U);
  EXPECT_EQ(next.find_webhook(id)->url, "http://hub/secret");
  EXPECT_EQ(next.find_webhook(id)->events, std::vector<std::string>{"warning"});
  EXPECT_EQ(next.find_printer("Voron")->key, "secret");
  EXPECT_EQ(next.find_printer(next.printers().front().id)->kind, PrinterKind::moonraker);
}

TEST(AddressBook, KeepsTheCertificateThatAPrinterIsTrustedBy) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "addresses.json";
  AddressBook book(file);
  const std::string id = book.add(voron()).id;
  EXPECT_EQ(content_of(file).find("fingerprint"), std::string::npos);  // older versions read it
  const std::string fingerprint = "sha256//" + std::string(43, 'A') + "=";
  EXPECT_EQ(book.trust("none", fingerprint), std::nullopt);
  EXPECT_EQ(book.trust(id, fingerprint)->name, "Voron");
  EXPECT_EQ(AddressBook(file).find_printer(id)->fingerprint, fingerprint);
}

TEST(AddressBook, IsForItsOwnerAlone) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "addresses.json";
  AddressBook(file).add(voron());
  struct ::stat info {};
  ASSERT_EQ(::stat(file.c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 0777U, 0600U);
}

TEST(AddressBook, RemovesOneAndLeavesTheOthers) {
  const TemporaryFolder folder;
  AddressBook book(folder.path() / "addresses.json");
  const std::string first = book.add(Webhook{.url = "http://one/"}).id;
  const std::string second = book.add(Webhook{.url = "http://two/"}).id;
  EXPECT_TRUE(book.remove_webhook(first));
  EXPECT_FALSE(book.remove_webhook(first));
  EXPECT_FALSE(book.find_webhook(first));
  EXPECT_TRUE(book.find_webhook(second));
}

TEST(AddressBook, HasOnePrinterOfAName) {
  const TemporaryFolder folder;
  AddressBook book(folder.path() / "addresses.json");
  book.add(voron());
  EXPECT_EQ(code_thrown_by([&] { book.add(voron()); }), "bad-settings");
}

TEST(AddressBook, HasAnEnd) {
  const TemporaryFolder folder;
  AddressBook book(folder.path() / "addresses.json");
  for (std::size_t i = 0; i < AddressBook::max_of_each; ++i) {
    book.add(Webhook{.url = "http://one/"});
  }
  EXPECT_EQ(code_thrown_by([&] { book.add(Webhook{.url = "http://one/"}); }), "bad-settings");
}

TEST(AddressBook, HasNothingOfAMalformedFile) {
  const TemporaryFolder folder;
  put(folder.path() / "addresses.json", R"({"webhooks": [{"id": "1", "url": "ftp://x/"}]})");
  AddressBook book(folder.path() / "addresses.json");
  EXPECT_TRUE(book.webhooks().empty());
  book.add(voron());  // still accepts new entries
  EXPECT_EQ(book.printers().size(), 1U);
}

TEST(Webhook, IsReadFromWhatAPersonWrites) {
  const Webhook webhook =
      to_webhook({{"url", "http://hub:8123/api/webhook/x"}, {"events", {"scan-finished"}}});
  EXPECT_EQ(webhook.url, "http://hub:8123/api/webhook/x");
  EXPECT_EQ(webhook.events, std::vector<std::string>{"scan-finished"});
  EXPECT_TRUE(to_webhook({{"url", "https://hub/"}}).events.empty());
}

TEST(Webhook, GoesToWebAddressesAlone) {
  for (const char* url : {"", "hub", "ftp://hub/", "file:///etc/passwd", "http://user:word@hub/",
                          "http://hub/#part", "http://", "javascript:alert(1)", "http://a b/"}) {
    EXPECT_EQ(code_thrown_by([&] { to_webhook({{"url", url}}); }), "bad-settings") << url;
  }
  EXPECT_EQ(code_thrown_by([&] {
              to_webhook({{"url", "http://hub/"}, {"events", {"scan-exploded"}}});
            }),
            "bad-settings");
}

TEST(Printer, IsReadFromWhatAPersonWrites) {
  const Printer printer = to_printer({{"name", "MK4"},
                                      {"kind", "prusalink"},
                                      {"url", "http://mk4.local/"},
                                      {"user", "maker"},
                                      {"key", "word"}});
  EXPECT_EQ(printer.kind, PrinterKind::prusalink);
  EXPECT_EQ(printer.url, "http://mk4.local");  // without a slash, so that paths can be appended
  EXPECT_EQ(printer.user, "maker");
}

TEST(Printer, HasAKindThatIsKnownAndAKeyOfOneLine) {
  const json good{{"name", "A"}, {"kind", "octoprint"}, {"url", "http://a/"}};
  for (const json& change :
       std::vector<json>{{{"kind", "bambu"}},
                         {{"name", ""}},
                         {{"url", "http://a/?x=1"}},
                         {{"key", "a\r\nX-Other: b"}},
                         {{"fingerprint", "sha256//"}},
                         {{"fingerprint", std::string(52, 'A')}},
                         {{"fingerprint", "sha256//" + std::string(44, 'A')}},
                         {{"fingerprint", "sha256//a;b" + std::string(40, 'A') + "="}}}) {
    json body = good;
    body.update(change);
    EXPECT_EQ(code_thrown_by([&] { to_printer(body); }), "bad-settings") << change;
  }
}

}  // namespace
}  // namespace octurn
