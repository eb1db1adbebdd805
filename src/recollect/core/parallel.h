#pragma once

#include <cstdint>
#include <functional>
#include <memory>

namespace recollect {

// A fixed set of worker threads that share out loops. Work is cut into the same chunks whatever
// the number of threads, so a loop whose chunks are independent gives the same bits with any.
class ThreadPool {
 public:
  // threads: how many run a loop, the caller among them; 0 takes one for each hardware thread.
  explicit ThreadPool(int threads = 0);
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  int threads() const;

  // Calls body(begin, end) for consecutive chunks of [0, count), each `grain` long but the last.
  // Returns when all are done; the first exception thrown by a body is rethrown here and chunks
  // not yet begun are left out. Not to be called from within a body.
  void For(std::int64_t count, std::int64_t grain,
           const std::function<void(std::int64_t begin, std::int64_t end)>& body);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace recollect
