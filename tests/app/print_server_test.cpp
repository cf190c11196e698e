#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>

#include "outgoing/printer_uploads.hpp"

namespace octurn {
namespace {

bool has_header(const OutgoingRequest& request, const std::string& header) {
  return std::ranges::count(request.headers, header) == 1;
}

TEST(PrintServer, IsSentAModelAsItsInterfaceSays) {
  const Printer octoprint{.kind = PrinterKind::octoprint, .url = "http://a/octo", .key = "k"};
  const OutgoingRequest form = upload_request(octoprint, "/data/Scan.stl", "Owl.stl", "");
  EXPECT_EQ(form.method + " " + form.url, "POST http://a/octo/api/files/local");
  EXPECT_EQ(form.form_name, "Owl.stl");
  EXPECT_TRUE(has_header(form, "X-Api-Key: k"));
  EXPECT_EQ(form.time_limit, std::chrono::hours(1));
  EXPECT_EQ(form.still_limit, std::chrono::seconds(30));

  const Printer moonraker{.kind = PrinterKind::moonraker, .url = "http://b"};
  const OutgoingRequest keyless = upload_request(moonraker, "/data/Scan.stl", "Owl.stl", "");
  EXPECT_EQ(keyless.method + " " + keyless.url, "POST http://b/server/files/upload");
  EXPECT_TRUE(keyless.headers.empty());

  const Printer prusalink{
      .kind = PrinterKind::prusalink, .url = "http://c", .user = "maker", .key = "word"};
  const OutgoingRequest put = upload_request(prusalink, "/data/Scan.stl", "my owl/1.stl", "/usb");
  EXPECT_EQ(put.method + " " + put.url, "PUT http://c/api/v1/files/usb/my%20owl%2F1.stl");
  EXPECT_EQ(put.user + ":" + put.password, "maker:word");
  EXPECT_TRUE(has_header(put, "Print-After-Upload: ?0"));
  EXPECT_FALSE(has_header(put, "X-Api-Key: word"));
}

TEST(PrintServer, GetsNamesThatAreNoFolders) {
  EXPECT_EQ(printer_file_name("Vase 1/2.stl"), "Vase 1-2.stl");
  EXPECT_EQ(printer_file_name("Teil 3\\4.stl"), "Teil 3-4.stl");
  EXPECT_EQ(printer_file_name("../oben.stl"), "-oben.stl");
  EXPECT_EQ(printer_file_name("...stl"), "Scan.stl");
  EXPECT_EQ(printer_file_name("鸟笼.stl"), "鸟笼.stl");
}

TEST(PrintServer, SaysInItsOwnWordsWhyItRefuses) {
  const Printer printer{.kind = PrinterKind::moonraker};
  const auto told = [&](const std::string& body) {
    return trouble_in(printer, {.status = 400, .body = body})->detail;
  };
  EXPECT_EQ(told(R"({"error": {"code": 400, "message": "Root gcodes not available"}})"),
            "Moonraker answered 400: Root gcodes not available");
  EXPECT_EQ(told(R"({"error": "Can not upload file, invalid file name"})"),
            "Moonraker answered 400: Can not upload file, invalid file name");
  EXPECT_EQ(told(R"({"error": "no such root\nTraceback"})"),
            "Moonraker answered 400: no such root");
  EXPECT_EQ(told("no such root\nTraceback"), "Moonraker answered 400: no such root");
  for (const char* silent : {"", "<html>", "{}", "[1]", R"({"error": null})", "\x80\xff"}) {
    EXPECT_EQ(told(silent), "Moonraker answered 400: it refuses the file") << silent;
  }
  EXPECT_NE(trouble_in(printer, {.status = 413})->hint.find("nginx"), std::string::npos);
}

TEST(PrintServer, KeepsFilesWhereItCanWrite) {
  EXPECT_EQ(usable_storage(R"({"storage_list": [
                {"path": "/sd", "available": true, "read_only": true},
                {"path": "/usb/", "available": true, "read_only": false}]})"),
            "/usb");
  EXPECT_EQ(usable_storage(R"({"storage_list": [{"path": "/usb", "available": false}]})"),
            std::nullopt);
  EXPECT_EQ(usable_storage("<html>"), std::nullopt);
}

TEST(PrintServer, SaysWhatIsWrongAndWhatToDo) {
  const Printer printer{.kind = PrinterKind::prusalink};
  EXPECT_EQ(trouble_in(printer, {.status = 201}), std::nullopt);
  for (const int status : {301, 400, 401, 403, 404, 409, 413, 415, 500, 507}) {
    const auto trouble = trouble_in(printer, {.status = status});
    ASSERT_TRUE(trouble) << status;
    EXPECT_NE(trouble->detail.find(std::to_string(status)), std::string::npos);
    EXPECT_NE(trouble->hint, "") << status;
  }
  const auto silent = trouble_in(printer, {.trouble = "Could not resolve host: mk4.local"});
  EXPECT_NE(silent->detail.find("mk4.local"), std::string::npos);
  EXPECT_NE(trouble_in(printer, {.status = 415})->hint.find("slice"), std::string::npos);
}

TEST(PrintServer, OffersToTrustACertificateAndNoneInItsPlace) {
  Printer printer{.kind = PrinterKind::octoprint};
  const OutgoingAnswer answer{.trouble = "self-signed certificate", .fingerprint = "sha256//A="};
  EXPECT_EQ(trouble_in(printer, answer)->fingerprint, "sha256//A=");
  printer.fingerprint = "sha256//B=";
  EXPECT_EQ(trouble_in(printer, answer)->fingerprint, "");
  EXPECT_NE(trouble_in(printer, answer)->detail.find("sha256//A="), std::string::npos);
}

}  // namespace
}  // namespace octurn
