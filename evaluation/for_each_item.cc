// SPDX-License-Identifier: Apache-2.0
#include "evaluation/for_each_item.h"

#include <algorithm>
#include <cstddef>
#include <exception>
#include <mutex>
#include <new>
#include <utility>
#include <vector>

#include "igf/base/parallel_for.h"

namespace rsstab::evaluation {
namespace {

Status WorkSafely(const std::function<Status(int index, MethodSet& methods)>& work, int index,
                  MethodSet& methods) {
  try {
    return work(index, methods);
  } catch (const std::bad_alloc&) {
    return Fail(ErrorCode::kIo, "out of memory");
  } catch (const std::exception& exception) {
    return Fail(ErrorCode::kInternal, "{}", exception.what());
  }
}

}  // namespace

Status ForEachItem(int count, int jobs, const MethodFactory& factory,
                   const std::function<Status(int index, MethodSet& methods)>& work,
                   const std::function<void(int index, const Error& error)>& failed,
                   const EvaluationProgress& progress) {
  const int threads = std::clamp(jobs, 1, std::max(count, 1));
  std::vector<MethodSet> sets;
  sets.reserve(static_cast<std::size_t>(threads));
  std::vector<MethodSet*> idle;
  idle.reserve(static_cast<std::size_t>(threads));
  for (int i = 0; i < threads; ++i) {
    auto methods = factory();
    if (!methods) {
      return Propagate(methods.error());
    }
    sets.push_back(std::move(*methods));
    idle.push_back(&sets.back());  // `sets` does not grow beyond what it has reserved
  }
  std::mutex mutex;  // guards `idle`, `done`, `stopped`, and calls to `failed` and `progress`
  std::int64_t done = 0;
  bool stopped = false;
  WorkerPool pool(threads);
  pool.ForBlocks(count, 1, [&](int begin, int) {
    std::unique_lock lock(mutex);
    if (stopped) {
      return;
    }
    MethodSet* const methods = idle.back();
    idle.pop_back();
    lock.unlock();
    const Status status = WorkSafely(work, begin, *methods);
    lock.lock();
    idle.push_back(methods);
    if (!status) {
      failed(begin, status.error());
    }
    ++done;
    if (progress && !progress(done, count)) {
      stopped = true;
    }
  });
  if (stopped) {
    return Fail(ErrorCode::kCancelled, "Stopped; nothing was written.");
  }
  return {};
}

}  // namespace rsstab::evaluation
