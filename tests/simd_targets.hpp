#pragma once

#include <string>

#include <gtest/gtest.h>
#include <hwy/targets.h>

namespace brink::test {

/// Runs a test with each set of instructions that was compiled and that this machine has, then lets the best one be chosen
/// again.
template <typename Test>
void for_each_target(const Test& test) {
  const auto choose = [](auto targets) {
    hwy::SetSupportedTargetsForTest(targets);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  };
  for (const auto target : hwy::SupportedAndGeneratedTargets()) {
    choose(target);
    SCOPED_TRACE(std::string("target ") + hwy::TargetName(target));
    test();
  }
  choose(0);
}

}  // namespace brink::test
