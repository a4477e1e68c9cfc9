// The short run: each seed is accepted, and thousands of damaged copies are refused or accepted, never worse.
#include "fuzz/targets.h"
#include "volmark/error.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace volmark::fuzz {
namespace {

constexpr int kCopies = 3000;

class Fuzz : public testing::TestWithParam<Target> {};

std::string damaged(std::string bytes, std::mt19937& random) {
  const auto below = [&](std::size_t count) { return count == 0 ? 0 : random() % count; };
  for (std::size_t times = 1 + below(4); times > 0; --times) {
    const std::size_t at = below(bytes.size());
    switch (below(6)) {
    case 0: bytes.resize(at); break;
    case 1: bytes.insert(at, 1 + below(9), static_cast<char>(random())); break;
    case 2: bytes.erase(at, 1 + below(9)); break;
    case 3: bytes.insert(at, bytes.substr(below(bytes.size()), below(40))); break;
    case 4: bytes.replace(at, std::min<std::size_t>(2, bytes.size() - at), "\xff\x7f"); break;
    default:
      if (!bytes.empty()) bytes[at] = static_cast<char>(random());
    }
  }
  return bytes;
}

TEST_P(Fuzz, DamagedFilesAreRefusedInOneLineOrRead) {
  std::mt19937 random(1); // mersenne twister: the same numbers everywhere
  for (const std::string& seed : GetParam().seeds)
    for (int i = 0; i < kCopies; ++i)
      GetParam().run(damaged(seed, random));
}

TEST_P(Fuzz, SeedsAreAccepted) {
  for (const std::string& seed : GetParam().seeds)
    EXPECT_TRUE(GetParam().run(seed));
}

INSTANTIATE_TEST_SUITE_P(All, Fuzz, testing::ValuesIn(targets()), [](const auto& test) { return test.param.name; });

} // namespace
} // namespace volmark::fuzz
