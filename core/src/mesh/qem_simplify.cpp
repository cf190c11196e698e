#include "mesh/qem_simplify.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "mesh/collapse_pass.hpp"
#include "octurn/snapshot.hpp"

namespace octurn {
namespace {

constexpr int passes = 6;
constexpr int max_strips = 8;  // of narrower ones most collapses are near a border
constexpr double full_error_pass = 0.6 * passes;  // from this on the limit is the target

}  // namespace

void qem_simplify(IndexedMesh& mesh, std::span<const char> locked, const CollapseLimits& limits,
                  const std::stop_token& stop, ThreadTeam& team) {
  // Along y first: marching cubes number their vertices row by row, so that threads seldom write
  // side by side.
  const int strips = std::min(team.size(), max_strips);
  std::vector<VertexStrips> tilings;
  if (team.size() > 1) {
    tilings = {make_strips(mesh.vertices, 1, strips, team),
               make_strips(mesh.vertices, 0, strips, team)};
  }
  // The limit rises, so that cheap collapses come first all over the mesh although the adjacency
  // is built once a pass.
  double already_tried = 0;
  std::vector<char> dirty(mesh.vertices.size(), 1);
  for (int pass = 0; pass < passes; ++pass) {
    throw_if_stopped(stop);
    const double share = std::min(1.0, (pass + 1) / full_error_pass);
    const double error = limits.target_error * share;
    CollapsePass collapses(mesh, locked, limits, std::move(dirty), team);
    const std::size_t done = collapses.run(error * error, already_tried, tilings);
    dirty = collapses.take_dirty();
    already_tried = error * error;
    if (done == 0 && share == 1.0) {
      break;
    }
  }
}

}  // namespace octurn
