#include "mesh/collapse.hpp"

#include <algorithm>
#include <bit>
#include <tuple>

#include "parallel/radix_sort.hpp"

namespace octurn {
namespace {

/// Moves each collapse to where its index is in the order, along one cycle after the other: a
/// second list would be as long again.
void reorder(std::vector<Collapse>& collapses, std::vector<KeyIndex>& order) {
  for (std::uint32_t start = 0; start < order.size(); ++start) {
    const Collapse first = collapses[start];
    std::uint32_t to = start;
    for (std::uint32_t from = order[to].index; from != start; from = order[to].index) {
      collapses[to] = collapses[from];
      order[to].index = to;
      to = from;
    }
    collapses[to] = first;
    order[to].index = to;
  }
}

}  // namespace

// By the upper half of the bits of their costs, which order as the costs do, as these are not
// negative; then the few that have those bits in common by the whole key.
void sort_by_cost(std::vector<Collapse>& collapses) {
  std::vector<KeyIndex> keys;
  keys.reserve(collapses.size());
  for (const Collapse& collapse : collapses) {
    keys.push_back(
        {.key = static_cast<std::uint32_t>(std::bit_cast<std::uint64_t>(collapse.cost) >> 32),
         .index = static_cast<std::uint32_t>(keys.size())});
  }
  radix_sort(keys, 32);
  const auto whole_key = [&](const KeyIndex& key) {
    const Collapse& collapse = collapses[key.index];
    return std::tuple(collapse.cost, collapse.kept, collapse.removed);
  };
  for (auto first = keys.begin(); first != keys.end();) {
    const auto end =
        std::find_if(first, keys.end(), [&](const KeyIndex& key) { return key.key != first->key; });
    if (end - first > 1) {
      std::ranges::sort(first, end, {}, whole_key);
    }
    first = end;
  }
  reorder(collapses, keys);
  const auto end =
      std::unique(collapses.begin(), collapses.end(), [](const Collapse& a, const Collapse& b) {
        return a.kept == b.kept && a.removed == b.removed;
      });
  collapses.erase(end, collapses.end());
}

}  // namespace octurn
