// SPDX-License-Identifier: Apache-2.0
#include "igf/base/parallel_for.h"

#include <gtest/gtest.h>

#include <atomic>
#include <vector>

namespace rsstab {
namespace {

TEST(WorkerPool, VisitsEveryIndexOnceForAnyThreadCount) {
  for (const int threads : {1, 2, 5}) {
    WorkerPool pool(threads);
    for (const int count : {0, 1, 7, 1000}) {
      std::vector<std::atomic<int>> visits(static_cast<std::size_t>(count));
      pool.ForBlocks(count, 3, [&](int begin, int end) {
        for (int i = begin; i < end; ++i) {
          ++visits[static_cast<std::size_t>(i)];
        }
      });
      for (const auto& v : visits) {
        EXPECT_EQ(v.load(), 1);
      }
    }
  }
}

TEST(WorkerPool, BlocksDoNotDependOnThreads) {
  for (const int threads : {1, 4}) {
    WorkerPool pool(threads);
    std::atomic<int> blocks = 0;
    pool.ForBlocks(10, 4, [&](int begin, int) {
      EXPECT_EQ(begin % 4, 0);
      ++blocks;
    });
    EXPECT_EQ(blocks.load(), 3);
  }
}

TEST(WorkerPool, SurvivesManySmallJobs) {
  WorkerPool pool(3);
  std::atomic<int> sum = 0;
  for (int i = 0; i < 2000; ++i) {
    pool.ForBlocks(5, 1, [&](int begin, int) { sum += begin; });
  }
  EXPECT_EQ(sum.load(), 2000 * 10);
}

}  // namespace
}  // namespace rsstab
