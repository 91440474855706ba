// SPDX-License-Identifier: Apache-2.0
#include "igf/base/parallel_for.h"

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <vector>

namespace rsstab {

int ResolveThreadCount(int requested) {
  if (requested > 0) {
    return requested;
  }
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

struct WorkerPool::Impl {
  struct Job {
    int count = 0;
    int block = 1;
    const std::function<void(int, int)>* body = nullptr;
  };

  std::mutex mutex;
  std::condition_variable wake;
  std::condition_variable done;
  Job job;
  int next = 0;     // first index not handed out yet
  int running = 0;  // blocks handed out and not finished
  bool stop = false;
  std::vector<std::thread> threads;

  // Takes blocks until none is left. Called with the lock held, returns with it held.
  void Drain(std::unique_lock<std::mutex>& lock) {
    while (job.body != nullptr && next < job.count) {
      const int begin = next;
      const int end = std::min(job.count, begin + job.block);
      const auto* body = job.body;
      next = end;
      ++running;
      lock.unlock();
      (*body)(begin, end);
      lock.lock();
      --running;
    }
    if (running == 0) {
      done.notify_all();
    }
  }

  void Work() {
    std::unique_lock<std::mutex> lock(mutex);
    while (!stop) {
      wake.wait(lock, [this] { return stop || (job.body != nullptr && next < job.count); });
      if (!stop) {
        Drain(lock);
      }
    }
  }
};

WorkerPool::WorkerPool(int num_threads) : impl_(std::make_unique<Impl>()) {
  for (int i = 1; i < num_threads; ++i) {
    impl_->threads.emplace_back([this] { impl_->Work(); });
  }
}

WorkerPool::~WorkerPool() {
  {
    const std::lock_guard<std::mutex> lock(impl_->mutex);
    impl_->stop = true;
  }
  impl_->wake.notify_all();
  for (std::thread& thread : impl_->threads) {
    thread.join();
  }
}

int WorkerPool::num_threads() const { return static_cast<int>(impl_->threads.size()) + 1; }

void WorkerPool::ForBlocks(int count, int block, const std::function<void(int, int)>& body) {
  if (count <= 0) {
    return;
  }
  block = std::max(block, 1);
  if (impl_->threads.empty()) {
    for (int begin = 0; begin < count; begin += block) {
      body(begin, std::min(count, begin + block));
    }
    return;
  }
  std::unique_lock<std::mutex> lock(impl_->mutex);
  impl_->job = {count, block, &body};
  impl_->next = 0;
  impl_->wake.notify_all();
  impl_->Drain(lock);
  impl_->done.wait(lock, [this] { return impl_->running == 0; });
  impl_->job = {};
}

}  // namespace rsstab
