#include "store/tum_recording.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>

#include "support/temporary_folder.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

const std::filesystem::path by_hand = std::filesystem::path(OCTURN_GOLDEN) / "tum_recording";

/// Writes the two lists of a recording.
void put_lists(const TemporaryFolder& folder, std::string_view depth, std::string_view poses) {
  put(folder.path() / "depth.txt", depth);
  put(folder.path() / "groundtruth.txt", poses);
}

std::string refusal(std::string_view depth, std::string_view poses) {
  const TemporaryFolder folder;
  put_lists(folder, depth, poses);
  return error_thrown_by([&] { read_tum_recording(folder.path(), 1); }).what();
}

TEST(TumRecording, HasThePoseBetweenTheTwoAroundAnImage) {
  const TumRecording recording = read_tum_recording(by_hand, 1);

  ASSERT_EQ(recording.images.size(), 3U);
  EXPECT_EQ(recording.without_pose, 1U);  // seven seconds after the last pose
  const Eigen::Isometry3d& pose = recording.images[0].world_from_camera;
  // Half way between two poses.
  EXPECT_LT((pose.translation() - Eigen::Vector3d(1.1, 0.05, 1.5)).norm(), 1e-4);
  // Half a quarter turn about Z.
  const Eigen::Vector3d x = pose.linear().col(0);
  EXPECT_LT((x - Eigen::Vector3d(std::sqrt(0.5), std::sqrt(0.5), 0)).norm(), 1e-3);
}

TEST(TumRecording, HasThePoseOfTheSameTimeAsItIs) {
  const TumRecording recording = read_tum_recording(by_hand, 1);

  const Eigen::Isometry3d& pose = recording.images.at(1).world_from_camera;
  EXPECT_EQ(pose.translation(), Eigen::Vector3d(1.25, 0.1, 1.4));
  // The optical axis, turned by -90 degrees about X, points along Y; the image's Y points down.
  EXPECT_LT((pose.linear().col(2) - Eigen::Vector3d::UnitY()).norm(), 1e-4);
  EXPECT_LT((pose.linear().col(1) + Eigen::Vector3d::UnitZ()).norm(), 1e-4);
}

TEST(TumRecording, TakesOneImageOfSoMany) {
  const TumRecording recording = read_tum_recording(by_hand, 2);

  ASSERT_EQ(recording.images.size(), 2U);
  EXPECT_EQ(recording.images[0].file, "depth/1305031102.160407.png");
  EXPECT_EQ(recording.images[1].file, "depth/1305031102.226738.png");
}

TEST(TumRecording, DoesNotInterpolateOverALongGap) {
  const TemporaryFolder folder;
  put_lists(folder, "1.0 a.png\n1.5 b.png\n", "1.0 0 0 0 0 0 0 1\n2.0 0 0 0 0 0 0 1\n");

  const TumRecording recording = read_tum_recording(folder.path(), 1);

  EXPECT_EQ(recording.images.size(), 1U);
  EXPECT_EQ(recording.without_pose, 1U);
}

TEST(TumRecording, LeavesOutImagesNearAPoseThatWasLost) {
  for (const char* lost : {"nan nan nan nan nan nan nan", "0 0 0 0 0 0 0"}) {
    const TemporaryFolder folder;
    put_lists(folder, "1.00 a.png\n1.04 b.png\n1.06 c.png\n1.10 d.png\n",
              "1.00 0 0 0 0 0 0 1\n1.05 " + std::string(lost) + "\n1.10 0 0 0 0 0 0 1\n");
    const TumRecording recording = read_tum_recording(folder.path(), 1);
    ASSERT_EQ(recording.images.size(), 2U) << lost;
    EXPECT_EQ(recording.images[1].file, "d.png");
    EXPECT_EQ(recording.without_pose, 2U);
  }
}

TEST(TumRecording, ReadsWhatOtherProgramsWrite) {
  const TemporaryFolder folder;
  // A byte order mark, a backslash, nanoseconds, a ninth column, and poses out of order.
  put_lists(folder,
            "\xEF\xBB\xBF"
            "1305031102150000000 depth\\a.png\r\n",
            "1305031102.2 2 0 0 0 0 0 1 2\r\n1305031102.1 1 0 0 0 0 0 1 1\r\n");
  const TumRecording recording = read_tum_recording(folder.path(), 1, 0.2);
  ASSERT_EQ(recording.images.size(), 1U);
  EXPECT_EQ(recording.images[0].file, "depth/a.png");
  EXPECT_NEAR(recording.images[0].world_from_camera.translation().x(), 1.5, 1e-4);
}

TEST(TumRecording, ReadsTheListsOfIclNuim) {
  const TemporaryFolder folder;
  put(folder.path() / "associations.txt", "0 depth/0.png 0 rgb/0.png\n1 depth/1.png 1 rgb/1.png\n");
  put(folder.path() / "livingRoom2.gt.freiburg", "1 0.5 0 0 0 0 0 1\n");
  const TumRecording recording = read_tum_recording(folder.path(), 1);
  ASSERT_EQ(recording.images.size(), 1U);
  EXPECT_EQ(recording.images[0].file, "depth/1.png");
  EXPECT_EQ(to_tum_camera(folder.path()), "icl-nuim");

  put(folder.path() / "associations.txt", "1 rgb/1.png 1 depth/1.png\n");
  EXPECT_EQ(read_tum_recording(folder.path(), 1).images.at(0).file, "depth/1.png");
}

TEST(TumRecording, SaysWhyNoImageHasAPose) {
  const std::string sparse = refusal("1.1 a.png\n", "1 0 0 0 0 0 0 1\n1.3 0 0 0 0 0 0 1\n");
  EXPECT_NE(sparse.find("up to 0.3 s apart"), std::string::npos) << sparse;
  const std::string apart =
      refusal("100 a.png\n101 b.png\n", "1 0 0 0 0 0 0 1\n1.05 0 0 0 0 0 0 1\n");
  EXPECT_NE(apart.find("100.000 to 101.000 s"), std::string::npos) << apart;
  EXPECT_NE(apart.find("1.000 to 1.050 s"), std::string::npos) << apart;
}

TEST(TumCamera, MirrorsAPoseWhoseYPointsUp) {
  EXPECT_LT(tum_camera("icl-nuim").fy, 0);
  const Eigen::Isometry3d pose =
      Eigen::Translation3d(1, 2, 3) * Eigen::AngleAxisd(0.5, Eigen::Vector3d(1, 2, 2) / 3);
  const Eigen::Isometry3d mirrored = with_y_down(pose);
  EXPECT_NEAR(mirrored.linear().determinant(), 1, 1e-12);
  const Eigen::Vector3d seen(0.1, 0.2, 2);
  const Eigen::Vector3d there = pose * seen;
  EXPECT_TRUE((mirrored * Eigen::Vector3d(0.1, -0.2, 2))
                  .isApprox(Eigen::Vector3d(there.x(), -there.y(), there.z())));
}

TEST(TumRecording, NamesFileAndLineOfWhatIsWrong) {
  const std::string poses = "1 0 0 0 0 0 0 1\n";
  const std::string depth = "1 a.png\n";
  EXPECT_NE(refusal(depth, "# x\n1 0 0 0 0 0 1\n").find("groundtruth.txt line 2"),
            std::string::npos);
  EXPECT_NE(refusal(depth, "1 0 0 zero 0 0 0 1\n").find("\"zero\" is no number"),
            std::string::npos);
  EXPECT_NE(refusal(depth, "1 0 0 0 0 0 0 2\n").find("quaternion"), std::string::npos);
  EXPECT_NE(refusal("1\n", poses).find("depth.txt line 1"), std::string::npos);
  EXPECT_NE(refusal("1 ../a.png\n", poses).find("\"../a.png\""), std::string::npos);
  EXPECT_NE(refusal("1 /a.png\n", poses).find("\"/a.png\""), std::string::npos);
}

TEST(TumRecording, SaysWhatIsMissing) {
  const TemporaryFolder folder;
  EXPECT_EQ(code_thrown_by([&] { read_tum_recording(folder.path(), 1); }), "scan-missing");
  put_lists(folder, "9 a.png\n", "1 0 0 0 0 0 0 1\n");
  EXPECT_EQ(code_thrown_by([&] { read_tum_recording(folder.path(), 1); }), "scan-empty");
}

TEST(TumCamera, HasThePublishedIntrinsicsAndTakesOthers) {
  EXPECT_DOUBLE_EQ(tum_camera("freiburg1").fx, 517.3);
  EXPECT_DOUBLE_EQ(tum_camera("freiburg3").cy, 247.6);
  EXPECT_DOUBLE_EQ(tum_camera("default").cx, 319.5);
  EXPECT_DOUBLE_EQ(tum_camera("default").depth_unit * 5000, 1.0);
  EXPECT_DOUBLE_EQ(tum_camera("30,31,15.5,11.5").fy, 31);
  EXPECT_EQ(to_tum_camera("/data/rgbd_dataset_freiburg2_desk/"), "freiburg2");
  EXPECT_EQ(to_tum_camera("/data/mine"), "default");
  for (const char* wrong : {"", "freiburg4", "1,2,3", "1,2,3,4,5", "0,1,2,3", "a,b,c,d"}) {
    EXPECT_EQ(code_thrown_by([&] { tum_camera(wrong); }), "bad-settings") << wrong;
  }
}

}  // namespace
}  // namespace octurn
