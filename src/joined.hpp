#pragma once

#include <cstddef>
#include <vector>

namespace brink {

/// The first of the items that are joined with one: each tells an earlier one, the first one itself. Shortens the ways there.
/// @param earlier the member that tells it, an index of `items`.
template <typename Item, typename Index>
Index find_first(std::vector<Item>& items, Index item, Index Item::*earlier) {
  const auto before = [&](Index i) -> Index& { return items[static_cast<std::size_t>(i)].*earlier; };
  while (before(item) != item) item = before(item) = before(before(item));
  return item;
}

}  // namespace brink
