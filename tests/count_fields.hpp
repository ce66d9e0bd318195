#pragma once

#include <cstddef>
#include <utility>

namespace brink::test {

// Stands for a value of any type: an aggregate of n fields can be made from up to n of them.
struct Anything {
  template <typename T>
  operator T() const;  // only named, never called
};

template <typename Aggregate, std::size_t... I>
constexpr bool can_be_made_of(std::index_sequence<I...> /*unused*/) {
  return requires { Aggregate{(static_cast<void>(I), Anything{})...}; };
}

/// Number of fields of an aggregate, so that a test notices the one that a table of fields lacks.
template <typename Aggregate, std::size_t Count = 0>
constexpr std::size_t count_fields() {
  if constexpr (can_be_made_of<Aggregate>(std::make_index_sequence<Count + 1>{})) return count_fields<Aggregate, Count + 1>();
  return Count;
}

}  // namespace brink::test
