#include "commands/commands.hpp"
#include "octurn/png.hpp"
#include "octurn/sensor_map.hpp"
#include "progress_bar.hpp"
#include "sensor/new_folder.hpp"
#include "signal_stop.hpp"

namespace octurn {
namespace {

constexpr int usual_wall_frames = 25;  // more frames do not lower the noise of the map

}  // namespace

void record_wall(const RecordArguments& arguments) {
  const Config config = make_config(arguments.config);
  const RigOptions options = rig_options(arguments.rig, config);
  load_sensor_drivers();  // changes the working directory: before the first thread
  const SignalStop signal;
  Rig rig(options);
  DepthSensor& sensor = rig.sensor();
  NewFolder folder(arguments.wall);
  Wall wall{.sensor_name = sensor.name(),
            .sensor_serial = sensor.serial(),
            .intrinsics = sensor.intrinsics(),
            .frames = {}};
  const int frames = arguments.frames.value_or(usual_wall_frames);
  ProgressBar bar;
  for (int frame = 0; frame < frames; ++frame) {
    bar.show(frame, frames, "recording");
    const std::optional<TimedFrame> timed = sensor.read(signal.token());
    if (!timed) {
      throw_stopped("no wall was written");
    }
    wall.frames.push_back(wall_frame_file(frame));
    write_depth_png(folder.path() / wall.frames.back(), timed->frame);
  }
  write_wall(folder.path(), wall);
  folder.commit();
}

}  // namespace octurn
