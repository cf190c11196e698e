#include "rig/simulation.hpp"

#include <array>
#include <charconv>
#include <limits>

#include "octurn/error.hpp"

namespace octurn {
namespace {

constexpr std::size_t longest_uri = 255;  // ONI_MAX_STR - 1
constexpr double max_noise = 100;
constexpr double max_pattern = 10;
constexpr double max_misalignment = 10;
constexpr double nearest_wall = 0.3;  // metres
constexpr double farthest_wall = 6;
constexpr double max_speed = 1000;

[[noreturn]] void refuse(const std::string& what) {
  throw Error(ErrorCode::bad_simulation, "simulator: " + what,
              "A simulated sensor is "
              "octurn-simulator://[MESH][?seed=N&noise=X&pattern=X&unit=N&misalignment=X"
              "&wall=X&speed=X&silent-after=N&lost-after=N].");
}

template <typename Number>
std::string to_text(Number value) {
  std::array<char, 32> text = {};
  const auto written = std::to_chars(text.begin(), text.end(), value);
  return {text.begin(), written.ptr};
}

template <typename Number>
Number parse_number(std::string_view key, std::string_view text, Number min, Number max) {
  Number value = {};
  const auto read = std::from_chars(text.begin(), text.end(), value);
  if (read.ec != std::errc() || read.ptr != text.end() || !(value >= min && value <= max)) {
    refuse(std::string(key) + "=" + std::string(text) + ": not a number from " + to_text(min) +
           " to " + to_text(max));
  }
  return value;
}

std::string encoded(std::string_view path) {
  std::string text;
  for (const char letter : path) {
    text += letter == '%' ? "%25" : letter == '?' ? "%3F" : std::string(1, letter);
  }
  return text;
}

std::string decoded(std::string_view text) {
  std::string path;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      path += text[i];
      continue;
    }
    const std::string_view digits = text.substr(i + 1, 2);
    unsigned char byte = 0;
    const auto read = std::from_chars(digits.begin(), digits.end(), byte, 16);
    if (digits.size() != 2 || read.ptr != digits.end() || byte == 0) {
      refuse("%" + std::string(digits) + " stands for no character");
    }
    path += static_cast<char>(byte);
    i += 2;
  }
  return path;
}

void set(Simulation& simulation, std::string_view key, std::string_view value) {
  constexpr int max_frames = std::numeric_limits<int>::max();
  if (key == "seed") {
    simulation.seed =
        parse_number(key, value, 0U, std::numeric_limits<decltype(simulation.seed)>::max());
  } else if (key == "noise") {
    simulation.noise = parse_number(key, value, 0.0, max_noise);
  } else if (key == "pattern") {
    simulation.pattern = parse_number(key, value, 0.0, max_pattern);
  } else if (key == "unit") {
    simulation.unit =
        parse_number(key, value, 0U, std::numeric_limits<decltype(simulation.unit)>::max());
  } else if (key == "misalignment") {
    simulation.misalignment = parse_number(key, value, 0.0, max_misalignment);
  } else if (key == "wall") {
    simulation.wall = parse_number(key, value, nearest_wall, farthest_wall);
  } else if (key == "speed") {
    simulation.speed = parse_number(key, value, 1 / max_speed, max_speed);
  } else if (key == "silent-after") {
    simulation.silent_after = parse_number(key, value, 0, max_frames);
  } else if (key == "lost-after") {
    simulation.lost_after = parse_number(key, value, 0, max_frames);
  } else {
    refuse("unknown key \"" + std::string(key) + "\"");
  }
}

}  // namespace

std::chrono::steady_clock::duration frame_period(const Simulation& simulation) {
  constexpr double frames_per_second = 30;
  return std::chrono::duration_cast<std::chrono::steady_clock::duration>(
      std::chrono::duration<double>(1 / (frames_per_second * simulation.speed)));
}

std::string simulation_uri(const Simulation& simulation) {
  const Simulation usual;
  std::string query;
  const auto add = [&query](const char* key, const std::string& value) {
    query += (query.empty() ? "?" : "&") + std::string(key) + "=" + value;
  };
  if (simulation.seed != usual.seed) {
    add("seed", to_text(simulation.seed));
  }
  if (simulation.noise != usual.noise) {
    add("noise", to_text(simulation.noise));
  }
  if (simulation.pattern != usual.pattern) {
    add("pattern", to_text(simulation.pattern));
  }
  if (simulation.unit != usual.unit) {
    add("unit", to_text(simulation.unit));
  }
  if (simulation.misalignment != usual.misalignment) {
    add("misalignment", to_text(simulation.misalignment));
  }
  if (simulation.wall) {
    add("wall", to_text(*simulation.wall));
  }
  if (simulation.speed != usual.speed) {
    add("speed", to_text(simulation.speed));
  }
  if (simulation.silent_after) {
    add("silent-after", to_text(*simulation.silent_after));
  }
  if (simulation.lost_after) {
    add("lost-after", to_text(*simulation.lost_after));
  }
  std::string uri = std::string(simulator_scheme) + encoded(simulation.mesh_file) + query;
  if (uri.size() > longest_uri) {
    throw Error(ErrorCode::bad_simulation,
                "simulator: the path of the mesh is too long: " + simulation.mesh_file,
                "Copy the mesh to a folder with a shorter path, at most about 180 letters.");
  }
  return uri;
}

Simulation parse_simulation(std::string_view uri) {
  if (!uri.starts_with(simulator_scheme)) {
    refuse("\"" + std::string(uri) + "\" is no URI of a simulated sensor");
  }
  uri.remove_prefix(simulator_scheme.size());
  const std::size_t question = uri.find('?');
  Simulation simulation;
  simulation.mesh_file = decoded(uri.substr(0, question));
  std::string_view query = question == uri.npos ? "" : uri.substr(question + 1);
  while (!query.empty()) {
    const std::string_view pair = query.substr(0, query.find('&'));
    const std::size_t equals = pair.find('=');
    set(simulation, pair.substr(0, equals), equals == pair.npos ? "" : pair.substr(equals + 1));
    query.remove_prefix(std::min(query.size(), pair.size() + 1));
  }
  return simulation;
}

}  // namespace octurn
