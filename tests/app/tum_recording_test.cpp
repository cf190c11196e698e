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

TEST(TumRecording, NamesFileAndLineOfWhatIsWrong) {
  const std::string poses = "1 0 0 0 0 0 0 1\n";
  const std::string depth = "1 a.png\n";
  EXPECT_NE(refusal(depth, "# x\n1 0 0 0 0 0 1\n").find("groundtruth.txt line 2"),
            std::string::npos);
  EXPECT_NE(refusal(depth, "1 0 0 zero 0 0 0 1\n").find("\"zero\" is no number"),
            std::string::npos);
  EXPECT_NE(refusal(depth, "1 0 0 nan 0 0 0 1\n").find("\"nan\" is no number"), std::string::npos);
  EXPECT_NE(refusal(depth, "1 0 0 0 0 0 0 2\n").find("quaternion"), std::string::npos);
  EXPECT_NE(refusal(depth, "2 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n").find("line 2"), std::string::npos);
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
