// SPDX-License-Identifier: Apache-2.0
#include "cli/bounded_queue.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

namespace rsstab::cli {
namespace {

TEST(BoundedQueue, KeepsOrderAcrossThreadsAndNeverHoldsMore) {
  BoundedQueue<int> queue(2);
  std::atomic<int> pushed = 0;
  std::thread producer([&] {
    for (int i = 0; i < 1000; ++i) {
      queue.Push(i);
      ++pushed;
    }
    queue.Close();
  });
  int expected = 0;
  while (const std::optional<int> value = queue.Pop()) {
    EXPECT_EQ(*value, expected++);
    EXPECT_LE(pushed.load(), expected + 2);
  }
  producer.join();
  EXPECT_EQ(expected, 1000);
}

TEST(BoundedQueue, CloseWakesAProducerThatWaitsForRoom) {
  BoundedQueue<int> queue(1);
  EXPECT_TRUE(queue.Push(1));
  std::thread producer([&] { EXPECT_FALSE(queue.Push(2)); });
  queue.Close();
  producer.join();
  EXPECT_EQ(queue.Pop(), 1);
  EXPECT_EQ(queue.Pop(), std::nullopt);
}

}  // namespace
}  // namespace rsstab::cli
