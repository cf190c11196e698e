// The check of an archive takes bounded time and memory, and ends when it is asked to.

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <stop_token>
#include <string>
#include <vector>

#include "app/scan_import_fixture.hpp"
#include "octurn/scan_folder.hpp"
#include "octurn/sensor_map.hpp"
#include "octurn/snapshot.hpp"
#include "zip_file.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class ScanArchiveCheck : public ScanImport {};

TEST_F(ScanArchiveCheck, DecodesAnImageOnceThatManySnapshotsName) {
  // Decoding it 4,000 times would take minutes, far more than a test may.
  constexpr int side = 2000;
  json scan = one_image_scan(4000, side, side);
  for (std::size_t i = 0; i < 4000; ++i) {
    scan["snapshots"][i]["file"] = std::string(i % 3, '/').insert(0, "snapshots/") + "000.png";
  }
  EXPECT_EQ(imported_and_read_back(
                {{{"scan.json", scan.dump()}, {"snapshots/000.png", depth_png_of(side, side)}}}),
            1U);
}

TEST_F(ScanArchiveCheck, EndsOnceItIsAskedToStop) {
  ScanStore store(data_.path());
  std::stop_source stop;
  stop.request_stop();
  EXPECT_THROW(import(store, files_of(one_image_scan(2)), stop.get_token()), Stopped);
  EXPECT_TRUE(store.list().empty());
}

TEST_F(ScanArchiveCheck, CountsTheFilesBeforeItUnpacksAny) {
  std::vector<ArchivedFile> files = files_of(one_image_scan(2));
  for (int i = 1; i <= 5000; ++i) {
    files.push_back({shot_file(i), ""});
  }
  put(data_.path() / "scan.zip", make_zip(files, {}));
  const fs::path folder = data_.path() / "scan";
  fs::create_directory(folder);
  const Error error =
      error_thrown_by([&] { read_scan_archive(data_.path() / "scan.zip", folder); });
  EXPECT_EQ(error.code(), ErrorCode::bad_request);
  EXPECT_NE(std::string(error.what()).find("more than 4096 files"), std::string::npos);
  EXPECT_TRUE(fs::is_empty(folder));
}

TEST_F(ScanArchiveCheck, RefusesAListOfFilesThatDeclaresTooMuchBeforeItUnpacksAny) {
  const std::vector<ArchivedFile> files{{"scan.json", std::string(1000, ' ')},
                                        {"job.json", std::string(1000, ' ')}};
  put(data_.path() / "scan.zip", make_zip(files, {}));
  const auto check = [&](const ZipLimits& limits) {
    check_zip(
        data_.path() / "scan.zip", [](std::string_view name) { return std::string(name); }, limits);
  };
  EXPECT_NO_THROW(check({.files = 2, .file_bytes = 1000, .all_bytes = 2000}));
  EXPECT_EQ(code_thrown_by([&] { check({.files = 1}); }), "bad-request");
  EXPECT_EQ(code_thrown_by([&] { check({.file_bytes = 999}); }), "bad-request");
  EXPECT_EQ(code_thrown_by([&] { check({.all_bytes = 1999}); }), "bad-request");
}

TEST_F(ScanArchiveCheck, ReadsWhatWasUnpackedAndPackedAgain) {
  const std::vector<ArchivedFile> files = files_of(one_image_scan(2));
  std::vector<ArchivedFile> packed{{"My scan/", ""},
                                   {"My scan/.DS_Store", "x"},
                                   {"__MACOSX/My scan/._scan.json", "x"},
                                   {"__MACOSX/scan.json", "x"},
                                   {"My scan/snapshots/", ""},
                                   {"My scan/snapshots/notes.pdf", "x"},
                                   {"receipt.pdf", "x"}};
  for (const ArchivedFile& file : files) {
    packed.push_back({"My scan/" + file.name, file.content});
  }
  ScanStore store(data_.path());
  const Job job = import(store, packed);
  EXPECT_EQ(job.snapshots_done, 2);
  std::set<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(store.folder(job.id))) {
    names.insert(entry.path().lexically_relative(store.folder(job.id)).string());
  }
  EXPECT_EQ(names,
            (std::set<std::string>{"job.json", "scan.json", "snapshots", "snapshots/000.png"}));
}

TEST_F(ScanArchiveCheck, NamesTheFileInPlaceOfAScan) {
  const Error error = refusal({{"scan.zip", "x"}});
  EXPECT_EQ(error.code(), ErrorCode::bad_request);
  EXPECT_NE(std::string(error.what()).find("no scan.json, but scan.zip"), std::string::npos)
      << error.what();
}

TEST_F(ScanArchiveCheck, RefusesImagesThatTakeTooMuchMemoryBeforeItDecodesThem) {
  const auto with_size = [](int columns, int rows) {
    return std::vector<ArchivedFile>{{"scan.json", one_image_scan(1, columns, rows).dump()},
                                     {"snapshots/000.png", "no image"}};
  };
  EXPECT_NE(std::string(refusal(with_size(4096, 3072)).what()).find("not a whole PNG"),
            std::string::npos);
  EXPECT_NE(std::string(refusal(with_size(4097, 3072)).what()).find("must have at most 12582912"),
            std::string::npos);
  auto files = with_size(2049, 2048);
  files.push_back({"sensor-map.png", "no map"});
  EXPECT_NE(std::string(refusal(files).what()).find("at most 4194304 with a sensor map"),
            std::string::npos);
}

TEST_F(ScanArchiveCheck, RefusesASensorMapOfAnotherSizeBeforeItDecodesIt) {
  const SensorMap map{
      .width = 5, .height = 3, .near_inverse_depth = 1, .near = std::vector<float>(15)};
  const std::vector<std::byte> png = encode_sensor_map(map);
  auto files = files_of(one_image_scan(1));
  // Cut off within the pixels: only its head can be read.
  files.push_back({"sensor-map.png", text_of({png.begin(), png.end() - 20})});
  EXPECT_NE(std::string(refusal(files).what()).find("it has another size"), std::string::npos);
}

TEST_F(ScanArchiveCheck, RefusesAScanJsonOfTooManyValuesWithFewBytes) {
  std::string snapshots = "[]";
  for (int i = 0; i < 200'000; ++i) {
    snapshots += ",[]";
  }
  json scan = one_image_scan(1);
  scan["snapshots"] = "LIST";
  std::string text = scan.dump();
  text.replace(text.find("\"LIST\""), 6, "[" + snapshots + "]");
  const Error error = refusal({{"scan.json", text}, {"snapshots/000.png", depth_png_of(4, 3)}});
  EXPECT_EQ(error.code(), ErrorCode::bad_request);
  EXPECT_NE(std::string(error.what()).find("more than 200000 values"), std::string::npos)
      << error.what();
}

}  // namespace
}  // namespace octurn
