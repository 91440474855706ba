// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_IGF_BASE_PARALLEL_FOR_H_
#define RSSTAB_IGF_BASE_PARALLEL_FOR_H_

#include <functional>
#include <memory>

namespace rsstab {

// Turns "0 = all" into a number of threads, once, at the top.
[[nodiscard]] int ResolveThreadCount(int requested);

// A few threads that wait for work. One caller at a time (not thread safe); owns its threads.
class WorkerPool {
 public:
  // num_threads >= 1 counts the calling thread; 1 runs everything inline.
  explicit WorkerPool(int num_threads);
  ~WorkerPool();
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  [[nodiscard]] int num_threads() const;

  // Calls body(begin, end) for consecutive blocks of at most `block` of [0, count) and returns when
  // all are done. The partition depends on count and block only, never on the number of threads, so
  // per-block results are the same for any of them. `body` must not throw.
  void ForBlocks(int count, int block, const std::function<void(int begin, int end)>& body);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rsstab

#endif  // RSSTAB_IGF_BASE_PARALLEL_FOR_H_
