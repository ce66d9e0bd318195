#pragma once

#include <cstddef>
#include <numeric>
#include <vector>

namespace brink {

/// The numbers of items, group by group, those of a group in their order.
struct Groups {
  std::vector<std::size_t> begins;  ///< of the groups in `items`, and the end of the last
  std::vector<std::size_t> items;
};

/// Counts, then puts each item in its place. @param group_of the number of an item's group, below `groups`.
template <typename Item, typename GroupOf>
Groups group_items(const std::vector<Item>& items, std::size_t groups, const GroupOf& group_of) {
  Groups result{std::vector<std::size_t>(groups + 1, 0), std::vector<std::size_t>(items.size())};
  for (const Item& item : items) ++result.begins[group_of(item) + 1];
  std::partial_sum(result.begins.begin(), result.begins.end(), result.begins.begin());
  std::vector<std::size_t> next = result.begins;
  for (std::size_t i = 0; i < items.size(); ++i) result.items[next[group_of(items[i])]++] = i;
  return result;
}

}  // namespace brink
